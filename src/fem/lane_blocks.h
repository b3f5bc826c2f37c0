#pragma once
// Element matrices in SIMD lanes. Only the six edge blocks K_ab, a < b, are computed. By translation
// invariance the blocks of each row sum to zero, so a diagonal block is minus the sum of the other blocks of
// its row. It is computed once for the whole chunk (lane_flush.h), or by the reader of the matrix.

/// Common factors of an element's blocks, in addition to the law's: F g_a = k_a and F' g_a = l_a, whose sums
/// over the four nodes are zero.
template <class Law>
struct BlockParts {
  Pack gg[4][4];  ///< g_a . g_b for a != b
  typename Law::BlockParts elastic;
  Vector k[4], l[4];
  Symmetric B2;  ///< damping: mu_d F F^T, scaled
  Pack damping_mu, damping_lambda;
  Matrix FFdot;  ///< damping's derivative by position: F F'^T
  Pack g_Sigma_g[4][4];
  Pack position_mu, position_lambda, position;
};

/// block += mu_d ((g_a . g_b) B2 + k_b k_a^T) + lambda_d k_a k_b^T, scaled.
template <class Law>
PALPATE_INLINE void add_damping_block(Matrix& block, const BlockParts<Law>& e, int a, int b) {
  block = block + e.gg[a][b] * full(e.B2);
  add_outer(block, e.damping_mu * e.k[b], e.k[a]);
  add_outer(block, e.damping_lambda * e.k[a], e.k[b]);
}

/// block += (g_a . Sigma g_b) I + mu_d ((g_a . g_b) F F'^T + k_b l_a^T) + lambda_d k_a l_b^T, scaled.
template <class Law>
PALPATE_INLINE void add_position_block(Matrix& block, const BlockParts<Law>& e, int a, int b) {
  block = block + (e.position_mu * e.gg[a][b]) * e.FFdot;
  add_outer(block, e.position_mu * e.k[b], e.l[a]);
  add_outer(block, e.position_lambda * e.k[a], e.l[b]);
  add_diagonal(block, e.position * e.g_Sigma_g[a][b]);
}

PALPATE_INLINE void scatter_block(const ChunkBlocks& blocks, const std::uint16_t* edge, const Matrix& block) {
  const Pack k[8] = {block.row[0].x, block.row[0].y, block.row[0].z, block.row[1].x,
                     block.row[1].y, block.row[1].z, block.row[2].x, block.row[2].y};
  scatter_rows(blocks.first, edge, k);
  for (int l = 0; l < kWidth; ++l) blocks.last[edge[l]] += block.row[2].z[l];
}

enum class Blocks { kDampingOnly, kWarped, kElastic };

template <class Law, Blocks kBlocks, bool kDamped, bool kByPosition>
PALPATE_INLINE void edge_block(const std::uint16_t* edge, const BlockParts<Law>& e, int a, int b,
                               const ChunkBlocks& upper, const ChunkBlocks& lower) {
  Matrix block{};
  if constexpr (kBlocks != Blocks::kDampingOnly)
    block = Law::template block<kBlocks == Blocks::kWarped>(e.elastic, e.gg[a][b], a, b);
  if constexpr (kDamped) add_damping_block(block, e, a, b);
  if constexpr (kByPosition) {
    Matrix below{{{block.row[0].x, block.row[1].x, block.row[2].x},
                  {block.row[0].y, block.row[1].y, block.row[2].y},
                  {block.row[0].z, block.row[1].z, block.row[2].z}}};
    add_position_block(below, e, b, a);
    scatter_block(lower, edge, below);
    add_position_block(block, e, a, b);
  }
  scatter_block(upper, edge, block);
}

/// Computes p[a][b] = g_a . v_b for a != b, for v_b = S g_b with a symmetric S: p is symmetric, and each row
/// sums to zero.
PALPATE_INLINE void products_with_gradients(const Gradients& G, const Vector* v, Pack (&p)[4][4]) {
  const Pack p11 = G.xx * v[1].x + G.xy * v[1].y + G.xz * v[1].z, p22 = G.yy * v[2].y + G.yz * v[2].z,
             p33 = G.zz * v[3].z;
  p[1][2] = p[2][1] = G.yy * v[1].y + G.yz * v[1].z;
  p[1][3] = p[3][1] = G.zz * v[1].z;
  p[2][3] = p[3][2] = G.zz * v[2].z;
  p[0][1] = p[1][0] = -(p11 + p[1][2] + p[1][3]);
  p[0][2] = p[2][0] = -(p[1][2] + p22 + p[2][3]);
  p[0][3] = p[3][0] = -(p[1][3] + p[2][3] + p33);
}

template <class Law>
PALPATE_INLINE void set_damping(BlockParts<Law>& e, const ElementModel& model, const Matrix& F, Pack volume) {
  const Pack d = model.d_scale * volume;
  e.damping_mu = model.damping_mu * d;
  e.damping_lambda = model.damping_lambda * d;
  const Symmetric FFt = gram_of_rows(F);
  e.B2 = {e.damping_mu * FFt.xx, e.damping_mu * FFt.yy, e.damping_mu * FFt.zz,
          e.damping_mu * FFt.yz, e.damping_mu * FFt.xz, e.damping_mu * FFt.xy};
}

template <class Law>
PALPATE_INLINE void set_position(BlockParts<Law>& e, const ElementModel& model, const Matrix& F,
                                 const Matrix& F_dot, const Gradients& G, Pack volume) {
  spread(F_dot, G, e.l);
  Vector Sigma_g[4];
  spread(full(damping_stress(symmetric_product(F, F_dot), model)), G, Sigma_g);
  products_with_gradients(G, Sigma_g, e.g_Sigma_g);
  e.FFdot = times_transposed(F, F_dot);
  e.position = model.k_scale * volume;
  e.position_mu = model.damping_mu * e.position;
  e.position_lambda = model.damping_lambda * e.position;
}

template <class Law, Blocks kBlocks, bool kDamped, bool kByPosition>
PALPATE_INLINE void edge_blocks(const GroupEdges& edges, int first, const BlockParts<Law>& e,
                                RowPrefetch* rows, const ChunkBlocks& upper, const ChunkBlocks& lower) {
  const auto at_edge = [&](int number, int a, int b) __attribute__((always_inline)) {
    edge_block<Law, kBlocks, kDamped, kByPosition>(edges.edge[number] + first, e, a, b, upper, lower);
    if (rows) fetch_rows(*rows);
  };
  at_edge(0, 0, 1);
  at_edge(1, 0, 2);
  at_edge(2, 0, 3);
  at_edge(3, 1, 2);
  at_edge(4, 1, 3);
  at_edge(5, 2, 3);
}

template <class Law, bool kDamped, bool kByPosition>
PALPATE_INLINE void set_rates(BlockParts<Law>& e, const Lanes& at, const ElementModel& model, const Matrix& F,
                              const Gradients& G, Pack volume, const ChunkFields& fields) {
  const Vector g[4] = {{}, {G.xx, G.xy, G.xz}, {Pack{}, G.yy, G.yz}, {Pack{}, Pack{}, G.zz}};
  products_with_gradients(G, g, e.gg);
  if constexpr (kDamped || kByPosition) spread(F, G, e.k);
  if constexpr (kDamped) set_damping(e, model, F, volume);
  if constexpr (kByPosition) set_position(e, model, F, gradient_of(at, G, fields.v), G, volume);
}

/// Computes all requested quantities from one evaluation of the law: the blocks, and in a linearly implicit
/// step (kStep) the forces minus the stiffness times w.
template <class Law, Blocks kBlocks, bool kDamped, bool kByPosition, bool kStep>
static void blocks_of(const ElementGroup* groups, const GroupEdges* edges, int count,
                      const ElementModel& model, const ScalarPath& scalar, const ChunkFields& fields,
                      double* f, const ChunkBlocks& upper, const ChunkBlocks& lower, DeferredBlocks* before,
                      LaneCounts& counts) {
  for_each_element<Law>(
      groups, count, fields, scalar,
      counts, [&](const Lanes& at, const Matrix& F, const State<Law>& state) __attribute__((always_inline)) {
        const Gradients G = gradients(at);
        const Pack volume = at.volume();
        if (at.first == 0) fetch_ahead(edges, at.number);
        typename Law::ScalarModes modes;
        typename Law::Tangent tangent{};
        if constexpr (kBlocks == Blocks::kElastic || kStep)
          tangent = Law::tangent(model, F, state, scalar, modes, counts);
        if constexpr (kStep) {
          count_inverted(state.det, counts);
          add_forces(
              at, G, step_stress < Law,
              kDamped ? Damping::kOfVelocity : Damping::kNone > (at, G, F, state, tangent, model, fields),
              -volume, f);
        }
        BlockParts<Law> e;
        Law::template set_parts<kBlocks == Blocks::kWarped>(e.elastic, model, F, state, tangent, G, volume);
        set_rates<Law, kDamped, kByPosition>(e, at, model, F, G, volume, fields);
        edge_blocks<Law, kBlocks, kDamped, kByPosition>(edges[at.number], at.first, e,
                                                        kStep ? nullptr : fields.next_rows, upper, lower);
        Law::add_modes(tangent, edges[at.number], at, model.k_scale, upper, kByPosition ? &lower : nullptr);
        if constexpr (kStep)
          if (at.first == 0) scatter(*before, before->batch);
      });
}

template <class Law>
static void damping_blocks(const ElementGroup* groups, const GroupEdges* edges, int count,
                           const ElementModel& model, const ChunkFields& fields, const ChunkBlocks& upper) {
  for (int g = 0; g < count; ++g) {
    fetch_ahead(groups, g);
    fetch_ahead(edges, g);
    for (int part = 0; part < 8; part += kWidth) {
      const Lanes at{groups[g], part, g};
      const Gradients G = gradients(at);
      BlockParts<Law> e;
      set_rates<Law, true, false>(e, at, model, gradient_of(at, G, fields.x), G, at.volume(), fields);
      edge_blocks<Law, Blocks::kDampingOnly, true, false>(edges[g], part, e, fields.next_rows, upper, {});
    }
  }
}

template <class Law>
static void tangent(const ElementGroup* groups, const GroupEdges* edges, int count, const ElementModel& model,
                    const ScalarPath& scalar, const ChunkFields& fields, const ChunkBlocks& upper,
                    const ChunkBlocks& lower, LaneCounts& counts) {
  const bool damped = model.damping_mu > 0.0 && model.d_scale != 0.0, elastic = model.k_scale != 0.0;
  const bool by_position = elastic && model.by_position;
  const auto run = [&](auto* blocks) {
    blocks(groups, edges, count, model, scalar, fields, nullptr, upper, lower, nullptr, counts);
  };
  if (!elastic) return damping_blocks<Law>(groups, edges, count, model, fields, upper);
  if constexpr (Law::kHasWarped)
    if (model.warped) {
      if (by_position)
        return run(damped ? blocks_of<Law, Blocks::kWarped, true, true, false>
                          : blocks_of<Law, Blocks::kWarped, false, true, false>);
      return run(damped ? blocks_of<Law, Blocks::kWarped, true, false, false>
                        : blocks_of<Law, Blocks::kWarped, false, false, false>);
    }
  if (by_position)
    return run(damped ? blocks_of<Law, Blocks::kElastic, true, true, false>
                      : blocks_of<Law, Blocks::kElastic, false, true, false>);
  return run(damped ? blocks_of<Law, Blocks::kElastic, true, false, false>
                    : blocks_of<Law, Blocks::kElastic, false, false, false>);
}

template <class Law>
static void step(const ElementGroup* groups, const GroupEdges* edges, int count, const ElementModel& model,
                 const ScalarPath& scalar, const ChunkFields& fields, double* f, const ChunkBlocks& upper,
                 DeferredBlocks& before, LaneCounts& counts) {
  const bool damped = model.damping_mu > 0.0;
  const auto run = [&](auto* blocks) {
    blocks(groups, edges, count, model, scalar, fields, f, upper, {}, &before, counts);
  };
  if constexpr (Law::kHasWarped)
    if (model.warped)
      return run(damped ? blocks_of<Law, Blocks::kWarped, true, false, true>
                        : blocks_of<Law, Blocks::kWarped, false, false, true>);
  run(damped ? blocks_of<Law, Blocks::kElastic, true, false, true>
             : blocks_of<Law, Blocks::kElastic, false, false, true>);
}

template <class Law>
constexpr LawKernels kernels_of{force<Law>, apply_tangent<Law>, tangent<Law>,  step_force<Law>,
                                step<Law>,  energy<Law>,        von_mises<Law>};
