"""Tools without mechanics: errors, quantities, files, folders, compiling, numbers as text."""
