// Operations on a few vectors over the nodes at once, by every instruction set.
#include "linear/mixed_precision/response_columns.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

using linear::Columns;

constexpr int kNodes = 301;  // no multiple of any vector width
constexpr std::size_t kSize = 4 * kNodes;

Columns wave(int count, double phase) {
  Columns out;
  out.resize(count, kSize);
  out.set_zero();
  for (int k = 0; k < count; ++k)
    for (std::size_t i = 0; i < kSize; ++i)
      if (i % 4 != 3)
        out[k][i] = static_cast<float>(std::sin(0.37 * static_cast<double>(i * i % 101) + phase + k));
  return out;
}
MatX in_double(const Columns& V) {
  MatX out(kSize, V.count());
  for (int k = 0; k < V.count(); ++k)
    for (std::size_t i = 0; i < kSize; ++i) out(static_cast<Eigen::Index>(i), k) = V[k][i];
  return out;
}
std::vector<float*> pointers(Columns& V) {
  std::vector<float*> out;
  for (int k = 0; k < V.count(); ++k) out.push_back(V[k].data());
  return out;
}

}  // namespace

TEST(ResponseColumns, EverySetGivesThePlainSumsOfAnyCounts) {
  for (int limit = 0; limit <= 2; ++limit)
    for (const auto& [rows, columns] : {std::pair{1, 1}, {3, 2}, {4, 4}, {4, 5}, {7, 3}, {9, 10}}) {
      const linear::NodeKernels& kernels = linear::node_kernels(limit);
      SCOPED_TRACE(kernels.name);
      Columns V = wave(rows, 0.3), W = wave(columns, 1.9);
      const MatX v = in_double(V), w = in_double(W);
      const std::vector<float*> at_V = pointers(V), at_W = pointers(W);
      const std::vector<const float*> from(at_V.begin(), at_V.end()), across(at_W.begin(), at_W.end());
      MatX inner(rows, columns);
      kernels.inner_products(rows, columns, from.data(), across.data(), kSize, inner.data());
      EXPECT_LT((inner - v.transpose() * w).cwiseAbs().maxCoeff(), 1e-6 * kSize);
      Eigen::MatrixXf Y(rows, columns);
      for (Eigen::Index k = 0; k < Y.size(); ++k)
        Y.data()[k] = static_cast<float>(std::cos(3.0 * static_cast<double>(k)));
      kernels.add_columns(rows, columns, from.data(), Y.data(), at_W.data(), kSize);
      EXPECT_LT((in_double(W) - w - v * Y.cast<double>()).cwiseAbs().maxCoeff(), 1e-6 * rows);
      for (int k = 0; k < columns; ++k)
        for (std::size_t i = 0; i < linear::kVectorTail; ++i) EXPECT_EQ(W[k][kSize + i], 0.0f);
    }
}

TEST(ResponseColumns, AnInverseIsThatOfWhatIsMoreThanRounding) {
  const MatX v = in_double(wave(3, 0.3));
  MatX V(kSize, 4);
  V << v, v.col(0) + v.col(1);  // linearly dependent waves: two directions
  const VecX scale = (VecX(4) << 1.0, 1e-4, 1e3, 1.0).finished();
  const MatX G = scale.asDiagonal() * (V.transpose() * V) * scale.asDiagonal();
  const MatX inverse = linear::pseudo_inverse(G);
  EXPECT_LT((G * inverse * G - G).cwiseAbs().maxCoeff(), 1e-10 * G.cwiseAbs().maxCoeff());
  EXPECT_NEAR((G * inverse).trace(), 2.0, 1e-6) << "the rank";
  MatX none = MatX::Identity(2, 2);
  none(1, 1) = -1.0;
  EXPECT_EQ(linear::pseudo_inverse(none).size(), 0);
  none(1, 1) = NAN;
  EXPECT_EQ(linear::pseudo_inverse(none).size(), 0);
}

}  // namespace palpate
