"""One physical effect per file; absent means exactly zero."""
