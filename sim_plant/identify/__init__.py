"""Parameters and verdicts from recorded data, each with a confidence interval or a refusal."""
