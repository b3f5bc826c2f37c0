#pragma once
// One linearly implicit step's share of an element: its deformation gradient and its rotation serve force, product and blocks.

template <Blocks kBlocks, bool kDamped>
static void steps_of(const ElementGroup* groups, int count, const ElementModel& model, const ScalarPath& scalar, const ChunkFields& fields, double* f,
                     const ChunkBlocks& upper, LaneCounts& counts) {
  for (int g = 0; g < count; ++g) {
    fetch_ahead(groups, g, count);
    for (int part = 0; part < 8; part += kWidth) {
      const Lanes at{groups[g], part};
      const Matrix G = gradients(at), F = gradient_of(at, G, fields.x);
      const Pack volume = at.volume();
      Matrix R;
      Pack det;
      rotation(F, scalar, R, det, counts);
      const Mask inverted = det <= 0.0;
      if (any(inverted)) counts.inverted += count_of(inverted);
      const Symmetric C = coupling(model, F, R, scalar, counts);
      Matrix P = elastic_stress(model, F, R) + elastic_change(model, R, C, gradient_of(at, G, fields.w));
      if constexpr (kDamped) P = P + F * full(damping_stress(symmetric_product(F, gradient_of(at, G, fields.v)), model));
      add_forces(at, G, P, -volume, f);
      BlockParts e;
      set_elastic<kBlocks>(e, model, R, C, G, volume);
      if constexpr (kDamped) {
        set_gradients(e, F, G);
        set_damping(e, model, F, volume);
      }
      edge_blocks<kBlocks, kDamped, false>(at, e, upper, {});
    }
  }
}

static void step(const ElementGroup* groups, int count, const ElementModel& model, const ScalarPath& scalar, const ChunkFields& fields, double* f,
                 const ChunkBlocks& upper, LaneCounts& counts) {
  const bool damped = model.damping_mu > 0.0;
  const auto run = [&](auto* steps) { steps(groups, count, model, scalar, fields, f, upper, counts); };
  if (model.warped) return run(damped ? steps_of<Blocks::kWarped, true> : steps_of<Blocks::kWarped, false>);
  run(damped ? steps_of<Blocks::kCoupled, true> : steps_of<Blocks::kCoupled, false>);
}
