"""What is launched: Gaussian beams, sampled profiles, slits; one source at many angles."""
