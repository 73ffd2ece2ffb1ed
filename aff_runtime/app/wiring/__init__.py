"""From a site file to the parts that the control process runs."""
