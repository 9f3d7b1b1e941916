"""What is launched: Gaussian beams, sampled profiles, slits; a source at many angles."""
