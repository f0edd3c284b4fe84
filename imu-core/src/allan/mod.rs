//! Allan and Hadamard variance, streaming, over octaves of the averaging time τ.
