//! Materials and the wavelength and critical-strain model of a stiff layer on a soft one.
