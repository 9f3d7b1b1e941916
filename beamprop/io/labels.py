"""The one schema of names: units and long name of every variable and coordinate of every dataset."""

from __future__ import annotations

#: Coordinates: (units, long name).
COORDINATES: dict[str, tuple[str, str]] = {
    "frequency": ("Hz", "frequency"),
    "angle": ("degree", "angle of incidence from the normal"),
    "azimuth": ("degree", "direction of the beam's tilt, from x towards y"),
    "x": ("m", "lateral position"),
    "y": ("m", "lateral position across x"),
    "z": ("m", "depth from the near face"),
    "kx": ("rad/m", "lateral wavenumber"),
    "kx_over_k0": ("1", "lateral wavenumber over that of the medium in front"),
    "mode": ("1", "number of the guided mode"),
    "axis": ("1", "direction along which a width or a place is taken"),
    "side": ("1", "reflected beam at the near face, or transmitted beam at the far face"),
}

#: Parameters that a study may vary.
PARAMETERS: dict[str, tuple[str, str]] = {
    "eta": ("1", "period over the wavelength at the design frequency"),
    "periods": ("1", "number of periods"),
    "n_layers": ("1", "layers in a period"),
    "rho_m": ("1", "mean density over that of the background"),
    "delta_rho": ("1", "modulation of the loss over the density of the background"),
    "design_frequency": ("Hz", "design frequency"),
    "thickness": ("m", "thickness"),
    "fwhm": ("m", "full width at half maximum of |p|"),
}

#: Variables of the questions about one slab and one beam.
ANSWERS: dict[str, tuple[str, str]] = {
    "kz": ("rad/m", "Bloch wavenumber"),
    "kz_over_k0": ("1", "Bloch wavenumber over that of the medium in front"),
    "direction": ("1", "energy along (+1) or against (-1) the phase, laterally; 0 where there is no mode"),
    "branch": ("1", "number of the dispersion curve along frequency; -1 where there is no mode"),
    "residual": ("1", "last step of the refinement over kx"),
    "count": ("1", "number of modes by the argument principle"),
    "width_1e2": ("m", "full width at 1/e^2 of the largest |p|^2"),
    "width_second_moment": ("m", "four standard deviations of |p|^2"),
    "centroid": ("m", "centroid of |p|^2"),
    "lateral_shift": ("m", "centroid less the geometric ray"),
    "peak": ("Pa", "largest |p|"),
    "power": ("1", "share of the launched power that radiates"),
    "divergence": ("degree", "far-field half-angle, two standard deviations of the power's direction"),
    "far_angle": ("degree", "mean direction of the radiated power"),
    "far_azimuth": ("degree", "azimuth of that direction, from x towards y"),
    "area": ("m^2", "connected area around the peak where |p| is at least half of it"),
    "ellipticity": ("1", "smaller over larger width by second moments, along their principal axes"),
    "orientation": ("degree", "direction of the larger of these, from x towards y"),
    "crossings": ("1", "how often |p| crosses the half level inside the window"),
    "moments_from": ("m", "begin of the interval of centroid and second moment"),
    "moments_to": ("m", "end of the interval of centroid and second moment"),
    "rim": ("1", "larger |p| at the ends of that interval over the peak"),
    "r": ("1", "complex pressure reflection coefficient"),
    "t": ("1", "complex pressure transmission coefficient"),
    "reflectivity": ("1", "reflectivity |r|^2"),
    "transmissivity": ("1", "transmissivity |t|^2"),
    "t_p": ("1", "P wave in the solid behind, rho w^2 phi over the incident pressure"),
    "t_s": ("1", "S wave in the solid behind, rho w^2 psi over the incident pressure"),
    "energy_transmission": ("1", "transmitted share of the incident power"),
    "absorption": ("1", "absorbed share of the incident power"),
    "p": ("Pa", "complex sound pressure, exp(-i w t)"),
    "v_x": ("m/s", "complex particle velocity along x, exp(-i w t)"),
    "v_y": ("m/s", "complex particle velocity along y, exp(-i w t)"),
    "v_z": ("m/s", "complex particle velocity along z, exp(-i w t)"),
    "u_x": ("m", "complex displacement along x, exp(-i w t)"),
    "u_y": ("m", "complex displacement along y, exp(-i w t)"),
    "u_z": ("m", "complex displacement along z, exp(-i w t)"),
    "s_xz": ("Pa", "complex shear stress, exp(-i w t); 0 in fluids"),
    "s_yz": ("Pa", "complex shear stress, exp(-i w t); 0 in fluids"),
    "intensity_x": ("W/m^2", "time-averaged intensity along x, Re(p v_x*)/2"),
    "intensity_y": ("W/m^2", "time-averaged intensity along y, Re(p v_y*)/2"),
    "intensity_z": ("W/m^2", "time-averaged intensity along z, Re(p v_z*)/2"),
    "power_through": ("W/m", "time-averaged power through the plane along z, for each metre along y"),
    "error_estimate": ("1", "estimated relative error: of a field, over the largest |p| of the plane"),
    "error_estimate_v_x": ("1", "estimated error of v_x over the largest |v_x| of the plane"),
    "error_estimate_v_y": ("1", "estimated error of v_y over the largest |v_y| of the plane"),
    "error_estimate_v_z": ("1", "estimated error of v_z over the largest |v_z| of the plane"),
    "error_estimate_u_x": ("1", "estimated error of u_x over the largest |u_x| of the plane"),
    "error_estimate_u_y": ("1", "estimated error of u_y over the largest |u_y| of the plane"),
    "error_estimate_u_z": ("1", "estimated error of u_z over the largest |u_z| of the plane"),
    "error_estimate_s_xz": ("1", "estimated error of s_xz over the largest |s_xz| of the plane"),
    "error_estimate_s_yz": ("1", "estimated error of s_yz over the largest |s_yz| of the plane"),
    "error_estimate_intensity_x": (
        "1",
        "estimated error of intensity_x over half the largest |p| times the largest |v_x|",
    ),
    "error_estimate_intensity_y": (
        "1",
        "estimated error of intensity_y over half the largest |p| times the largest |v_y|",
    ),
    "error_estimate_intensity_z": (
        "1",
        "estimated error of intensity_z over half the largest |p| times the largest |v_z|",
    ),
    "error_estimate_power_through": ("1", "estimated error of power_through over the power of the incident beam"),
    "r_error_estimate": ("1", "estimated error of r over the larger of |r| and 1"),
    "t_error_estimate": ("1", "estimated error of t over |t|"),
    "fwhm_launch": ("m", "full width at half maximum at the launch plane"),
    "fwhm_in": ("m", "full width at half maximum of the incident beam at the near face"),
    "fwhm_out": ("m", "full width at half maximum at the far face"),
    "fwhm_air": ("m", "full width at half maximum after the comparison distance without a slab"),
    "area_out": ("m^2", "connected area at half maximum around the peak at the far face"),
    "equivalent_out": ("m", "diameter of a disc of that area"),
    "peak_out": ("Pa", "largest |p| at the far face"),
    "centroid_out": ("m", "centroid of |p|^2 at the far face"),
}

#: Of fields in three dimensions, where it differs.
IN_SPACE: dict[str, tuple[str, str]] = {"power_through": ("W", "time-averaged power through the plane along z")}

#: Variables of the comparison of two fields a and b.
COMPARISON: dict[str, tuple[str, str]] = {
    "relative_l2": ("1", "relative L2 error"),
    "relative_l2_by_z": ("1", "relative L2 error at each depth"),
    "relative_l2_scaled": ("1", "relative L2 error after the best complex scale factor"),
    "scale": ("1", "complex factor that brings b nearest to a"),
    "largest_error": ("1", "largest |a - b| over the largest |a|"),
    "largest_error_x": ("m", "lateral position of the largest error"),
    "largest_error_y": ("m", "lateral position across x of the largest error"),
    "largest_error_z": ("m", "depth of the largest error"),
    "fwhm_a": ("m", "full width at half maximum of |a|"),
    "fwhm_b": ("m", "full width at half maximum of |b|"),
    "fwhm_difference": ("m", "full width of |b| less that of |a|"),
    "peak_a": ("Pa", "largest |a| at each depth"),
    "peak_b": ("Pa", "largest |b| at each depth"),
    "peak_difference": ("Pa", "largest |b| less largest |a|"),
    "p_a": ("Pa", "complex sound pressure of a"),
    "p_b": ("Pa", "complex sound pressure of b on a's grid"),
    "error": ("Pa", "|a - b|"),
    "interpolation_error": ("1", "estimated share of the error that comes from interpolating b"),
    "wraparound": ("1", "relative L2 difference that the period makes"),
}

#: All of them.
LABELS: dict[str, tuple[str, str]] = COORDINATES | PARAMETERS | ANSWERS | COMPARISON


def label(name: str, in_space: bool = False) -> dict[str, str]:
    """Attributes (units, long_name) of a variable or coordinate, also of a field in three dimensions."""
    units, long_name = (LABELS | IN_SPACE)[name] if in_space else LABELS[name]
    return {"units": units, "long_name": long_name}
