#pragma once

/// A unit mass on a slider with unit damping, u' = -u, u(0) = 1, by Simbody's CPodes at accuracy 1e-8: u(t),
/// exp(-t) to 1e-6.
double cpodes_decay(double t);
