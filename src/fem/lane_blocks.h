#pragma once
// The element matrices in lanes.  Only the six blocks K_ab, a < b, of the edges are made: a translation of the element changes nothing, so that
// the blocks of each row sum to zero and a diagonal block is minus the sum of the others of its row, taken once for the whole chunk (flush).

/// What the blocks of an element are made of; h_0 = -(h_1 + h_2 + h_3), and g, k, l likewise.
struct BlockParts {
  Vector g[4], h[4], k[4], l[4];
  Matrix hC[3];     ///< [h_a]x C, scaled
  Pack mu2, lambda; ///< 2 mu, lambda of stiffness, scaled
  Symmetric B2;     ///< mu_d F F^T of the damping, scaled
  Pack damping_mu, damping_lambda;
  Matrix FFdot;     ///< of the damping's derivative by position
  Vector Sigma_g[4];
  Pack position_mu, position_lambda, position;
};

PALPATE_INLINE void spread(const Matrix& M, const Matrix& G, Vector* v) {
  for (int a = 0; a < 3; ++a) v[a + 1] = apply(M, G.row[a]);
  v[0] = -(v[1] + v[2] + v[3]);
}

/// block += a b^T
PALPATE_INLINE void add_outer(Matrix& block, const Vector& a, const Vector& b) {
  block.row[0] = block.row[0] + a.x * b;
  block.row[1] = block.row[1] + a.y * b;
  block.row[2] = block.row[2] + a.z * b;
}
PALPATE_INLINE void add_diagonal(Matrix& block, Pack s) {
  block.row[0].x += s;
  block.row[1].y += s;
  block.row[2].z += s;
}

/// lambda h_a h_b^T + [h_a]x C [h_b]x + 2 mu (h_a . h_b) I.  A row m^T of [h_a]x C gives (m x h_b)^T.
PALPATE_INLINE Matrix coupled_block(const BlockParts& e, int a, int b) {
  Matrix block;
  for (int r = 0; r < 3; ++r) block.row[r] = cross(e.hC[a].row[r], e.h[b]);
  add_outer(block, e.lambda * e.h[a], e.h[b]);
  add_diagonal(block, e.mu2 * dot(e.h[a], e.h[b]));
  return block;
}

/// The same with C = mu I: lambda h_a h_b^T + mu h_b h_a^T + mu (h_a . h_b) I.
PALPATE_INLINE Matrix warped_block(const BlockParts& e, int a, int b) {
  const Vector p = e.lambda * e.h[a], q = (0.5 * e.mu2) * e.h[a];
  Matrix block{{p.x * e.h[b], p.y * e.h[b], p.z * e.h[b]}};
  add_outer(block, e.h[b], q);
  add_diagonal(block, dot(q, e.h[b]));
  return block;
}

/// mu_d ((g_a . g_b) B2 + k_b k_a^T) + lambda_d k_a k_b^T
PALPATE_INLINE void add_damping_block(Matrix& block, const BlockParts& e, int a, int b) {
  block = block + dot(e.g[a], e.g[b]) * full(e.B2);
  add_outer(block, e.damping_mu * e.k[b], e.k[a]);
  add_outer(block, e.damping_lambda * e.k[a], e.k[b]);
}

/// (g_a . Sigma g_b) I + mu_d ((g_a . g_b) F F'^T + k_b l_a^T) + lambda_d k_a l_b^T
PALPATE_INLINE void add_position_block(Matrix& block, const BlockParts& e, int a, int b) {
  block = block + (e.position_mu * dot(e.g[a], e.g[b])) * e.FFdot;
  add_outer(block, e.position_mu * e.k[b], e.l[a]);
  add_outer(block, e.position_lambda * e.k[a], e.l[b]);
  add_diagonal(block, e.position * dot(e.g[a], e.Sigma_g[b]));
}

PALPATE_INLINE void scatter_block(const ChunkBlocks& blocks, const std::uint16_t* edge, const Matrix& block) {
  const Pack k[8] = {block.row[0].x, block.row[0].y, block.row[0].z, block.row[1].x, block.row[1].y, block.row[1].z, block.row[2].x, block.row[2].y};
  scatter_rows(blocks.first, edge, k);
  for (int l = 0; l < kWidth; ++l) blocks.last[edge[l]] += block.row[2].z[l];
}

enum class Blocks { kDampingOnly, kWarped, kCoupled };

template <Blocks kBlocks, bool kDamped, bool kByPosition>
PALPATE_INLINE void edge_block(const Lanes& at, const BlockParts& e, int number, int a, int b, const ChunkBlocks& upper, const ChunkBlocks& lower) {
  Matrix block{};
  if constexpr (kBlocks == Blocks::kWarped) block = warped_block(e, a, b);
  if constexpr (kBlocks == Blocks::kCoupled) block = coupled_block(e, a, b);
  if constexpr (kDamped) add_damping_block(block, e, a, b);
  if constexpr (kByPosition) {
    Matrix below{{{block.row[0].x, block.row[1].x, block.row[2].x}, {block.row[0].y, block.row[1].y, block.row[2].y},
                  {block.row[0].z, block.row[1].z, block.row[2].z}}};
    add_position_block(below, e, b, a);
    scatter_block(lower, at.edge(number), below);
    add_position_block(block, e, a, b);
  }
  scatter_block(upper, at.edge(number), block);
}

template <Blocks kBlocks, bool kDamped, bool kByPosition>
static void blocks_of(const ElementGroup* groups, int count, const ElementModel& model, const ScalarPath& scalar, const ChunkFields& fields,
                      const ChunkBlocks& upper, const ChunkBlocks& lower, LaneCounts& counts) {
  for (int g = 0; g < count; ++g) {
    fetch_ahead(groups, g, count);
    for (int part = 0; part < 8; part += kWidth) {
      const Lanes at{groups[g], part};
      const Matrix G = gradients(at), F = gradient_of(at, G, fields.x);
      const Pack volume = at.volume();
      BlockParts e;
      if constexpr (kBlocks != Blocks::kDampingOnly) {
        Matrix R;
        Pack det;
        rotation(F, scalar, R, det, counts);
        const Pack k = model.k_scale * volume;
        e.mu2 = (2.0 * model.mu) * k;
        e.lambda = model.lambda * k;
        spread(R, G, e.h);
        if constexpr (kBlocks == Blocks::kCoupled) {
          const Matrix C = k * full(coupling(model, F, R, scalar, counts));
          for (int a = 0; a < 3; ++a) {
            const Vector& h = e.h[a];
            e.hC[a] = {{h.y * C.row[2] - h.z * C.row[1], h.z * C.row[0] - h.x * C.row[2], h.x * C.row[1] - h.y * C.row[0]}};
          }
        }
      }
      if constexpr (kDamped || kByPosition) {
        for (int a = 0; a < 3; ++a) e.g[a + 1] = G.row[a];
        e.g[0] = -(e.g[1] + e.g[2] + e.g[3]);
        spread(F, G, e.k);
      }
      if constexpr (kDamped) {
        const Pack d = model.d_scale * volume;
        e.damping_mu = model.damping_mu * d;
        e.damping_lambda = model.damping_lambda * d;
        const Symmetric FFt = gram_of_rows(F);
        e.B2 = {e.damping_mu * FFt.xx, e.damping_mu * FFt.yy, e.damping_mu * FFt.zz, e.damping_mu * FFt.yz, e.damping_mu * FFt.xz, e.damping_mu * FFt.xy};
      }
      if constexpr (kByPosition) {
        const Matrix F_dot = gradient_of(at, G, fields.v);
        spread(F_dot, G, e.l);
        spread(full(damping_stress(symmetric_product(F, F_dot), model)), G, e.Sigma_g);
        e.FFdot = times_transposed(F, F_dot);
        e.position = model.k_scale * volume;
        e.position_mu = model.damping_mu * e.position;
        e.position_lambda = model.damping_lambda * e.position;
      }
      edge_block<kBlocks, kDamped, kByPosition>(at, e, 0, 0, 1, upper, lower);
      edge_block<kBlocks, kDamped, kByPosition>(at, e, 1, 0, 2, upper, lower);
      edge_block<kBlocks, kDamped, kByPosition>(at, e, 2, 0, 3, upper, lower);
      edge_block<kBlocks, kDamped, kByPosition>(at, e, 3, 1, 2, upper, lower);
      edge_block<kBlocks, kDamped, kByPosition>(at, e, 4, 1, 3, upper, lower);
      edge_block<kBlocks, kDamped, kByPosition>(at, e, 5, 2, 3, upper, lower);
    }
  }
}

static void tangent(const ElementGroup* groups, int count, const ElementModel& model, const ScalarPath& scalar, const ChunkFields& fields,
                    const ChunkBlocks& upper, const ChunkBlocks& lower, LaneCounts& counts) {
  const bool damped = model.damping_mu > 0.0 && model.d_scale != 0.0, elastic = model.k_scale != 0.0;
  const bool by_position = elastic && model.by_position;
  const auto run = [&](auto* f) { f(groups, count, model, scalar, fields, upper, lower, counts); };
  if (!elastic) return run(blocks_of<Blocks::kDampingOnly, true, false>);
  if (model.warped) {
    if (by_position) return run(damped ? blocks_of<Blocks::kWarped, true, true> : blocks_of<Blocks::kWarped, false, true>);
    return run(damped ? blocks_of<Blocks::kWarped, true, false> : blocks_of<Blocks::kWarped, false, false>);
  }
  if (by_position) return run(damped ? blocks_of<Blocks::kCoupled, true, true> : blocks_of<Blocks::kCoupled, false, true>);
  return run(damped ? blocks_of<Blocks::kCoupled, true, false> : blocks_of<Blocks::kCoupled, false, false>);
}

// Blocks as rows of eight doubles and one.  Widths below eight go entry by entry: their time is in the memory as well.

#if PALPATE_WIDTH == 8
struct BlockSum {
  typedef double Row __attribute__((vector_size(64)));
  typedef double RowInMemory __attribute__((vector_size(64), may_alias, aligned(8)));
  typedef long long Places __attribute__((vector_size(64)));
  Row first{};
  double last = 0.0;
  /// Takes the block away from the sum, and adds it to the matrix.
  PALPATE_INLINE_MEMBER void move(const double* block_first, double block_last, bool transposed, double* to) {
    constexpr Places kPlaces[2] = {{0, 1, 2, 3, 4, 5, 6, 7}, {0, 3, 6, 1, 4, 7, 2, 5}};
    const Row block = __builtin_shuffle(Row(*reinterpret_cast<const RowInMemory*>(block_first)), kPlaces[transposed]);
    first -= block;
    last -= block_last;
    if (to == nullptr) return;
    *reinterpret_cast<RowInMemory*>(to) += block;
    to[8] += block_last;
  }
  PALPATE_INLINE_MEMBER void symmetrise() {
    const Row mirrored = __builtin_shuffle(first, Places{0, 3, 6, 1, 4, 7, 2, 5});
    first = 0.5 * (first + mirrored);
  }
  PALPATE_INLINE_MEMBER void store(double* to_first, double* to_last) const {
    *reinterpret_cast<RowInMemory*>(to_first) = first;
    *to_last = last;
  }
  PALPATE_INLINE_MEMBER void add_to(double* to) const {
    *reinterpret_cast<RowInMemory*>(to) += first;
    to[8] += last;
  }
};
#else
struct BlockSum {
  double first[8] = {};
  double last = 0.0;
  PALPATE_INLINE_MEMBER void move(const double* block_first, double block_last, bool transposed, double* to) {
    constexpr int kPlaces[2][8] = {{0, 1, 2, 3, 4, 5, 6, 7}, {0, 3, 6, 1, 4, 7, 2, 5}};
    double block[8];
    for (int c = 0; c < 8; ++c) block[c] = block_first[kPlaces[transposed][c]];
    for (int c = 0; c < 8; ++c) first[c] -= block[c];
    last -= block_last;
    if (to == nullptr) return;
    for (int c = 0; c < 8; ++c) to[c] += block[c];
    to[8] += block_last;
  }
  PALPATE_INLINE_MEMBER void symmetrise() {
    first[1] = first[3] = 0.5 * (first[1] + first[3]);
    first[2] = first[6] = 0.5 * (first[2] + first[6]);
    first[5] = first[7] = 0.5 * (first[5] + first[7]);
  }
  PALPATE_INLINE_MEMBER void store(double* to_first, double* to_last) const {
    for (int c = 0; c < 8; ++c) to_first[c] = first[c];
    *to_last = last;
  }
  PALPATE_INLINE_MEMBER void add_to(double* to) const {
    for (int c = 0; c < 8; ++c) to[c] += first[c];
    to[8] += last;
  }
};
#endif

/// The rows of the matrix that follow: six rows, some eighty blocks, take longer to add up than a line takes to come from memory.
constexpr int kRowsAhead = 6;
PALPATE_INLINE void fetch_row(const BlockTargets& targets, int n, const double* values) {
  if (n >= targets.nodes) return;
  const int begin = targets.row_start[n];
  for (int p = begin; p < begin + targets.row_own[n]; ++p) fetch(values + 9 * static_cast<std::int64_t>(targets.slots[p]), 64);
}

template <bool kSymmetric>
static void flush_rows(const BlockTargets& targets, const ChunkBlocks& upper, const ChunkBlocks& lower, const ChunkBlocks& diagonal, double* values) {
  for (int n = 0; n < targets.nodes; ++n) {
    fetch_row(targets, n + kRowsAhead, values);
    BlockSum sum;
    const int begin = targets.row_start[n], own = begin + targets.row_own[n], end = targets.row_start[n + 1];
    for (int p = begin; p < end; ++p) {
      const std::uint32_t edge = targets.entries[p] / 2;
      const bool second = targets.entries[p] % 2 != 0;
      const ChunkBlocks& blocks = !kSymmetric && second ? lower : upper;
      double* to = p < own ? values + 9 * static_cast<std::int64_t>(targets.slots[p]) : nullptr;
      sum.move(blocks.first + 8 * edge, blocks.last[edge], kSymmetric && second, to);
    }
    if (kSymmetric) sum.symmetrise();  // to the last bit: the two sides of an edge's block were summed in different orders
    if (n < targets.own_nodes)
      sum.add_to(values + 9 * static_cast<std::int64_t>(targets.diagonal[n]));
    else
      sum.store(diagonal.first + 8 * n, diagonal.last + n);
  }
}

static void flush(const BlockTargets& targets, const ChunkBlocks& upper, const ChunkBlocks& lower, bool symmetric, const ChunkBlocks& diagonal,
                  double* values) {
  if (symmetric)
    flush_rows<true>(targets, upper, lower, diagonal, values);
  else
    flush_rows<false>(targets, upper, lower, diagonal, values);
}
