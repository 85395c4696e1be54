"""What knows nothing of mechanics: errors, quantities, files, locks, compiling, numbers as text."""
