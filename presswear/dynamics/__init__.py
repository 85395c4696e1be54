"""What a motion is, from arrays alone: periods, modes of contact, sections, spectra, exponents."""
