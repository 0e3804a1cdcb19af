"""Plans and set-points as files."""
