"""What is decided in rational arithmetic on the doubles given."""
