"""One scene over a quantity: exponents, periods and sections, up and down."""
