"""The documents as a site: ``python -m releasing.pages`` builds it from ``mkdocs.yml``."""

__all__: list[str] = []
