#pragma once
#include <vector>

#include "palpate/dynamics/layout.h"
#include "palpate/dynamics/spec.h"

namespace palpate::integrate {

/// Computes the weights w of the norm sqrt(mean (w_i e_i)^2) in which an adaptive method measures its error,
/// for y = [q; u].
///     q:  1 / (rtol atol_q q_scale)
///     u:  1 / (rtol (atol_u u_scale + rms of u over the block))
/// No part of the tolerance of q grows with q: a body far from the origin is integrated like one at the
/// origin. The part of the tolerance of u that grows with u is one number per block, so the norm does not
/// depend on the axes. Angles and quaternions (Block::angles_q) have scale 1, angular velocities have scale
/// u_scale / q_scale and a separate rms. Driven directions have no error: their weights vanish, and the mean
/// is over the others.
/// @param u  current velocities
/// @param driven  one entry per u-direction
/// @param w  q_size + u_size entries
void error_weights(const dynamics::Layout& layout, const IntegratorSpec& spec,
                   const std::vector<char>& driven, const double* u, double* w);

}  // namespace palpate::integrate
