"""The site file as a form and as a text: edits, their try, what is kept."""

__all__ = ["form", "form_jobs", "jobs", "saving", "text_jobs"]
