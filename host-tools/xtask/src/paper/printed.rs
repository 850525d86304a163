//! What is printed in Weng, J.; Bian, X.; Kou, K.; Lian, T. *Optimization of Ring Laser Gyroscope
//! Bias Compensation Algorithm in Variable Temperature Environment.* Sensors 2020, 20(2), 377.
//!
//! By axis X, Y, Z; biases in pulses/s, temperatures in degC.

/// Table 1, static run: sigma uncompensated, static model without overlap, with overlap.
pub(super) const TABLE_1: [[f64; 3]; 3] = [
    [0.0233, 0.0174, 0.0173],
    [0.0280, 0.0190, 0.0189],
    [0.0335, 0.0086, 0.0071],
];

/// Table 2: a0, a1 and a2 of each segment. (The column of a2 is headed in units that make it 1e-5
/// of what is printed.)
pub(super) const TABLE_2: [[[f64; 3]; 4]; 3] = [
    [
        [0.0173, -0.0014, 1.7535e-5],
        [0.0064, 0.0004, -4.2567e-5],
        [-0.0551, 0.0026, -3.302e-5],
        [0.3390, -0.0118, 9.6146e-5],
    ],
    [
        [0.0184, -0.0014, -3.1281e-5],
        [0.0187, -0.0010, 1.3435e-5],
        [0.0884, -0.0040, 4.1885e-5],
        [0.1204, -0.0033, 1.5919e-5],
    ],
    [
        [0.0167, 0.0004, -2.07e-5],
        [0.0036, -0.0009, 3.9374e-5],
        [0.0635, -0.0042, 6.548e-5],
        [-0.0974, 0.0032, -2.7658e-5],
    ],
];

/// Table 3, variable-temperature run: sigma uncompensated, static model, composite model.
pub(super) const TABLE_3: [[f64; 3]; 3] = [
    [0.0533, 0.0512, 0.0187],
    [0.0229, 0.0232, 0.0193],
    [0.0471, 0.0467, 0.0454],
];

/// The segments of table 2.
pub(super) const SEGMENTS: &str = "-15:15,5:35,25:60,50:80";
