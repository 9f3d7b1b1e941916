"""Numbers that others printed, each table once: the page and the tests take them from here."""

from __future__ import annotations

#: IEC 61094-2, Table F.1: temperature (Celsius), pressure (Pa), humidity (%), density (kg/m3), speed (m/s).
IEC_AIR = ((23.0, 101325.0, 50.0, 1.1860848, 345.86652), (20.0, 80000.0, 65.0, 0.9441589, 344.38267))

#: ISO 9613-2, Table 2: temperature (Celsius), humidity (%), attenuation (dB/km) in the octaves from 63 Hz to 8 kHz.
ISO_ABSORPTION = (
    (10.0, 70.0, (0.1, 0.4, 1.0, 1.9, 3.7, 9.7, 32.8, 117.0)),
    (20.0, 70.0, (0.1, 0.3, 1.1, 2.8, 5.0, 9.0, 22.9, 76.6)),
    (30.0, 70.0, (0.1, 0.3, 1.0, 3.1, 7.4, 12.7, 23.1, 59.3)),
    (15.0, 20.0, (0.3, 0.6, 1.2, 2.7, 8.2, 28.2, 88.8, 202.0)),
    (15.0, 50.0, (0.1, 0.5, 1.2, 2.2, 4.2, 10.8, 36.2, 129.0)),
    (15.0, 80.0, (0.1, 0.3, 1.1, 2.4, 4.1, 8.3, 23.7, 82.8)),
)

#: Kell 1975: Celsius and kg/m3, air-free water.
WATER_DENSITY = ((0.0, 999.8395), (4.0, 999.9720), (20.0, 998.2041), (25.0, 997.0449), (40.0, 992.2158))

#: Pinkerton 1949: Celsius and alpha/f^2 (s2/m) of water.
WATER_ABSORPTION = ((0.0, 56.9e-15), (20.0, 25.3e-15), (40.0, 14.6e-15))

#: Bilaniuk and Wong 1993, 112 points: powers of the temperature (Celsius) of the speed in water (m/s).
WATER_SPEED = (1402.38744, 5.03836171, -5.81172916e-2, 3.34638117e-4, -1.48259672e-6, 3.16585020e-9)

#: CRC Handbook, "Velocity of sound in various media": speeds in thin rods (m/s).
RODS = {
    "aluminium": 5000,
    "beryllium": 12870,
    "brass": 3480,
    "copper": 3750,
    "gold": 2030,
    "iron": 5200,
    "lead": 1190,
    "molybdenum": 5400,
    "nickel": 4900,
    "platinum": 2800,
    "silver": 2680,
    "steel": 5200,
    "stainless steel": 5000,
    "tin": 2730,
    "titanium": 5080,
    "tungsten": 4620,
    "zinc": 3850,
    "fused silica": 5760,
    "pyrex": 5170,
    "acrylic": 1840,
    "nylon": 1800,
    "polyethylene": 920,
}

#: Rigid foams of the reference tables of pymls: flow resistivity, porosity, tortuosity, viscous and thermal length.
PLANES_FOAMS = {"foam": (87e3, 0.97, 2.52, 36e-6, 118e-6), "foam2": (15e3, 0.98, 1.05, 100e-6, 250e-6)}

#: PLANES, in the reference tables of pymls (tests/references/eqf of its repository): layers with thicknesses (m), angle (degree) and
#: frequency (Hz), r and t for exp(+j w t).
PLANES = (
    (
        ((("foam2", 0.1),), 35.0, 10.0),
        (0.5964683993613699 - 0.01554418514911515j),
        (0.4025858812929785 - 0.01519732088678013j),
    ),
    (
        ((("foam2", 0.1),), 35.0, 5350 / 3),
        (0.05933796194610935 - 0.1199196968704393j),
        (-0.1258533895493084 + 0.09237492055684224j),
    ),
    (
        ((("foam2", 0.1),), 35.0, 4000.0),
        (0.03460284700842356 - 0.05700388167858476j),
        (0.01248671413175254 - 0.105080817727916j),
    ),
    (
        ((("foam2", 0.01),), 80.0, 10.0),
        (0.03031378265068631 - 0.007054759480499244j),
        (0.9694324260130276 - 0.007456041670456261j),
    ),
    (
        ((("foam2", 0.01),), 80.0, 5350 / 3),
        (-0.3707347584924436 - 0.2184631543494412j),
        (0.5629426982215573 - 0.2895837221373668j),
    ),
    (
        ((("foam2", 0.01),), 80.0, 4000.0),
        (-0.4911463888187559 - 0.1603242678585524j),
        (0.4222579096273115 - 0.3163454287463923j),
    ),
    (
        ((("foam2", 0.01), ("foam", 0.1)), 35.0, 10.0),
        (0.8961327018168286 - 0.02370614824853474j),
        (0.1017472090389422 - 0.01194318080947851j),
    ),
    (
        ((("foam2", 0.01), ("foam", 0.1)), 35.0, 5350 / 3),
        (0.1943088649766617 - 0.3084619868551101j),
        (-0.002860719832603243 - 0.001768869804525961j),
    ),
    (
        ((("foam2", 0.01), ("foam", 0.1)), 35.0, 4000.0),
        (-0.002651419138629808 - 0.2367013622411224j),
        (-6.845955371611685e-05 + 0.0007212092511546986j),
    ),
    (
        ((("foam", 0.002),), 45.0, 10.0),
        (0.1291498392907754 + 0.0001180734883428466j),
        (0.8708486391486471 - 0.0008237854017765332j),
    ),
    (
        ((("foam", 0.002),), 45.0, 5350 / 3),
        (0.1305574552055577 + 0.02806371664193471j),
        (0.8447359296978146 - 0.1325103944727787j),
    ),
    (
        ((("foam", 0.002),), 45.0, 4000.0),
        (0.1547146384275132 + 0.05823435135638436j),
        (0.7872474258299942 - 0.2618716980685556j),
    ),
)

#: Brass (8400 kg/m3, 4400 and 2200 m/s), 1 mm thick, in water (1000 kg/m3, 1480 m/s), by the method of Kiefer, Ponschab, Rupitsch and Mayle (J. Acoust.
#: Soc. Am. 145, 3341, 2019) as Gravenkamp, Plestenjak, Kiefer and Jarlebring (J. Sound Vib. 2024, doi 10.1016/j.jsv.2024.118716) print it in
#: reference_BrassWater.mat of their Leaky-Guided-Waves-Examples: MHz; Re and |Im| of kx/k0 below 1.3 and 0.12, to nine decimals. Both signs
#: of Im are there; without a radiating partner it is 0.
BRASS_IN_WATER = {
    0.6697290969899666: ((0.394032351, 0.001659469), (0.904540035, 0.046738305), (1.000397978, 0.0), (1.019367573, 0.0)),
    1.3384581939799332: ((0.211912724, 0.002819944), (0.429529868, 0.008721171), (0.789337043, 0.017856345), (1.001271946, 0.0), (1.002331628, 0.0)),
    2.114183946488294: (
        (0.049184959, 0.016063151), (0.285763467, 0.003649531), (0.350770127, 0.005075885), (0.637354807, 0.022157814),
        (0.748244489, 0.012574368), (1.001643428, 0.0), (1.001748509, 0.0),
    ),
    2.6759163879598664: (
        (0.146311731, 0.008176058), (0.343213732, 0.000076509), (0.412787315, 0.008028870), (0.688589079, 0.017240050),
        (0.735788665, 0.011482938), (1.001685388, 0.0), (1.001704402, 0.0),
    ),
    4.0: (
        (0.294846031, 0.003025737), (0.319129209, 0.000630804), (0.408506290, 0.005463416), (0.577410957, 0.006182515),
        (0.715147930, 0.013550305), (0.724232121, 0.011212257), (1.001694702, 0.0), (1.001695015, 0.0),
    ),
}  # fmt: skip
#: Stride on benchmark 4 of the transcranial intercomparison with the bowl (PH1-BM4-SC1 of doi:10.5281/zenodo.6020543), by the intercomparison's
#: own functions: |p| (Pa) and z (m) of the focus on nodes 0.5 mm apart, -6 dB sizes along and across the axis (m).
STRIDE_BOWL = {"pressure": 316738.57, "position": 0.057, "length": 0.02728874, "width": 0.00434409}
