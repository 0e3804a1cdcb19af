"""Everything of a plan together: figures at a glance, films, pages."""
