#pragma once

/// Returns u(t) of a unit mass on a slider with unit damping, u' = -u, u(0) = 1, by Simbody's CPodes at
/// accuracy 1e-8: exp(-t) to 1e-6.
double cpodes_decay(double t);
