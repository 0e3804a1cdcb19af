"""Limits of a finger beyond its cone and its largest force: linear rows, such as those of its joints."""
