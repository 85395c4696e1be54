"""What happens to runs on other people's machines, tried on purpose."""
