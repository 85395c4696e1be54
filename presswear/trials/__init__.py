"""What holds the program against the truth; imported by nothing but its commands."""
