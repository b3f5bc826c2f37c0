#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "integrate/bent_beam.h"
#include "integrate/linear/node_kernels.h"
#include "integrate/linear/node_order.h"
#include "integrate/linear/row_packing.h"

namespace palpate {
namespace {

using namespace dynamics;

TEST(NodeKernels, EverySetGivesTheSameButForRounding) {
  BentBeam beam(8, 1e5);
  BorderedMatrix A;
  VecX b;
  beam.at(0.9, 1e-2, A, b);
  const auto n = static_cast<std::size_t>(A.body.block_rows());
  std::vector<int> source(static_cast<std::size_t>(A.body.slot_count())), diagonal(n);
  for (std::size_t s = 0; s < source.size(); ++s) source[s] = static_cast<int>(s);
  for (std::size_t i = 0; i < n; ++i) {
    diagonal[i] = A.body.diagonal(static_cast<int>(i));
    const auto row = source.begin() + A.body.row_start()[i];
    std::rotate(row, source.begin() + diagonal[i], source.begin() + diagonal[i] + 1);  // the row's own block first
  }
  std::vector<int> column;
  for (const int slot : source) column.push_back(A.body.columns()[static_cast<std::size_t>(slot)]);
  std::vector<int> row_start(A.body.row_start().begin(), A.body.row_start().end());
  integrate::NodeOrder order = integrate::cluster_nodes(A.body, 3, 3);
  for (std::size_t i = 0; i < n; ++i) order.node[i] = static_cast<int>(i);  // parts of nodes as they come: many blocks between parts
  integrate::RowPacking packing;
  packing.analyse(order, row_start, column);
  std::vector<double> v(4 * n + integrate::kVectorTail), Av(v);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t a = 0; a < 3; ++a) v[4 * i + a] = b[static_cast<Eigen::Index>(3 * i + a)];
  VecX exact;
  A.multiply(b, exact);
  for (int limit = 0; limit <= 2; ++limit) {
    const integrate::NodeKernels& k = integrate::node_kernels(limit);
    std::vector<float> values(9 * (source.size() + 1) + integrate::kBlockTail), p(4 * n + integrate::kVectorTail), q(p), inverse(static_cast<std::size_t>(integrate::inverse_place(static_cast<int>(n) + 3)));
    const integrate::DoubleBlocks D{row_start.data(), column.data(), source.data(), A.body.values().data(), A.body.slot_count() - 1};
    ASSERT_TRUE(k.convert(D, 1.0, values.data(), 0, static_cast<int>(n)));
    k.multiply_double(D, v.data(), Av.data(), 0, static_cast<int>(n));
    for (std::size_t i = 0; i < v.size(); ++i) p[i] = static_cast<float>(v[i]);
    std::vector<int> offset(packing.places() + integrate::kLanesOfGroup * integrate::kStepsAhead, 9 * static_cast<int>(source.size()));
    std::vector<std::uint16_t> turned(packing.places() / integrate::kLanesOfGroup, 0);
    for (std::size_t s = 0; s < source.size(); ++s)
      if (!packing.turned(s)) offset[packing.place(s)] = 9 * static_cast<int>(s);
    double pq = 0.0;
    for (std::size_t part = 0; part < 3; ++part) k.pack(packing.rows(part, nullptr), {values.data(), offset.data(), nullptr});
    for (std::size_t part = 0; part < 3; ++part) pq += k.product(packing.rows(part, nullptr), p.data(), q.data());
    ASSERT_TRUE(k.invert_diagonal(A.body.values().data(), diagonal.data(), 1.0, inverse.data(), 0, static_cast<int>(n)));
    const auto lacks_held_columns = [&](std::size_t i) { return beam.rest[static_cast<Eigen::Index>(3 * i)] < -0.5 + 0.2; };
    const auto off_identity = [&](bool balanced) {
      double most = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        if (balanced && lacks_held_columns(i)) continue;
        const Mat3 own = Eigen::Map<const Mat3>(A.body.block(diagonal[i]));
        Mat3 J;
        for (int c = 0; c < 3; ++c)
          for (int r = 0; r < 3; ++r) J(r, c) = inverse[static_cast<std::size_t>(integrate::inverse_place(static_cast<int>(i)) + (r == c ? r : integrate::kToOffDiagonal + 3 - r - c))];
        most = std::max(most, (own * J - Mat3::Identity()).norm());
      }
      return most;
    };
    double in_double = 0.0, in_single = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t a = 0; a < 3; ++a) {
        const double want = exact[static_cast<Eigen::Index>(3 * i + a)];
        in_double = std::max(in_double, std::abs(Av[4 * i + a] - want));
        in_single = std::max(in_single, std::abs(q[4 * i + a] - want));
      }
    EXPECT_LT(in_double, 1e-13 * exact.cwiseAbs().maxCoeff()) << k.name;
    EXPECT_LT(in_single, 1e-5 * exact.cwiseAbs().maxCoeff()) << k.name;
    EXPECT_NEAR(pq, b.dot(exact), 1e-5 * std::abs(b.dot(exact))) << k.name;
    EXPECT_LT(off_identity(false), 1e-5) << k.name;

    // Balanced: what is missing in a row's sum is its mass.  Blocks come turned and unturned.
    std::vector<double> mass(4 * n + integrate::kVectorTail);
    std::vector<float> mass_single(mass.size());
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t a = 0; a < 3; ++a) {
        double sum = 0.0;
        for (int s = A.body.row_start()[i]; s < A.body.row_start()[i + 1]; ++s)
          sum += A.body.columns()[static_cast<std::size_t>(s)] == static_cast<int>(i) ? A.body.block(s)[4 * a] : static_cast<float>(A.body.block(s)[4 * a]);
        mass[4 * i + a] = sum;
        mass_single[4 * i + a] = static_cast<float>(sum);
      }
    for (std::size_t s = 0; s < source.size(); ++s) {
      const std::size_t at = packing.place(s);
      if (packing.turned(s) || at % 3 != 0 || column[s] == static_cast<int>(std::upper_bound(row_start.begin(), row_start.end(), static_cast<int>(s)) - row_start.begin()) - 1) continue;
      Eigen::Map<Eigen::Matrix3f>(values.data() + 9 * s).transposeInPlace();
      turned[at / integrate::kLanesOfGroup] = static_cast<std::uint16_t>(turned[at / integrate::kLanesOfGroup] | 1u << at % integrate::kLanesOfGroup);
    }
    std::vector<float> sums(8 * n + integrate::kVectorTail), Vs[5], AVs[5];
    const float* V[5] = {};
    float* AV[5] = {};
    for (int c = 0; c < 5; ++c) {
      Vs[c] = p;
      AVs[c].resize(p.size());
      for (float& value : Vs[c]) value *= static_cast<float>(c + 1);
      V[c] = Vs[c].data();
      AV[c] = AVs[c].data();
    }
    std::fill(inverse.begin(), inverse.end(), 0.0f);
    std::fill(Av.begin(), Av.end(), 0.0);
    double trace = 0.0, all_traces = 0.0;
    for (std::size_t part = 0; part < 3; ++part) {
      const integrate::PackedRows rows = packing.rows(part, mass_single.data());
      ASSERT_EQ(k.balance(rows, {values.data(), offset.data(), turned.data()}, sums.data(), inverse.data(), &trace, static_cast<int>(part) + 3, V, AV), integrate::Balanced::kOk);
      all_traces += trace;
    }
    pq = 0.0;
    for (std::size_t part = 0; part < 3; ++part) {
      const integrate::PackedRows rows = packing.rows(part, mass_single.data());
      k.multiply_balanced(rows, mass.data(), 1.0, v.data(), Av.data());
      pq += k.product(rows, p.data(), q.data());
    }
    double off = 0.0, off_single = 0.0, off_columns = 0.0, traces = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      traces += Eigen::Map<const Mat3>(A.body.block(diagonal[i])).trace();
      if (lacks_held_columns(i)) continue;  // such rows are not balanced
      for (std::size_t a = 0; a < 3; ++a) {
        const double want = exact[static_cast<Eigen::Index>(3 * i + a)];
        off = std::max(off, std::abs(Av[4 * i + a] - want));
        off_single = std::max(off_single, std::abs(q[4 * i + a] - want));
        for (std::size_t c = 0; c < 3; ++c) off_columns = std::max(off_columns, std::abs(AVs[c][4 * i + a] / static_cast<double>(c + 1) - want));
      }
    }
    EXPECT_LT(off, 1e-6 * exact.cwiseAbs().maxCoeff()) << k.name;
    EXPECT_LT(off_single, 1e-5 * exact.cwiseAbs().maxCoeff()) << k.name;
    EXPECT_LT(off_columns, 1e-5 * exact.cwiseAbs().maxCoeff()) << k.name;
    EXPECT_NEAR(all_traces, traces, 1e-5 * traces) << k.name;
    EXPECT_LT(off_identity(true), 1e-5) << k.name;
    k.multiply(packing.rows(2, mass_single.data()), 5, V, AV);
    EXPECT_EQ(AVs[4][4 * (n - 1)], AVs[4][4 * (n - 1)]) << "a number";
    EXPECT_NEAR(AVs[4][4 * (n - 1)], 5.0 * q[4 * (n - 1)], 1e-4 * exact.cwiseAbs().maxCoeff()) << k.name;

    const int size = 21, stride = 32;
    MatX S = MatX::Random(size, size);
    S = S * S.transpose() + MatX::Identity(size, size);
    std::vector<float> E(size * stride, 0.0f), w(stride, 0.0f), y(stride, 0.0f);
    for (int i = 0; i < size; ++i) {
      y[static_cast<std::size_t>(i)] = static_cast<float>(S.row(i).sum());
      for (int j = 0; j < size; ++j) E[static_cast<std::size_t>(i * stride + j)] = static_cast<float>(S(i, j));
    }
    ASSERT_TRUE(k.invert(E.data(), size, stride));
    k.dense(E.data(), stride, y.data(), w.data(), 0, size);
    for (int i = 0; i < size; ++i) EXPECT_NEAR(w[static_cast<std::size_t>(i)], 1.0, 1e-3) << k.name;
  }
}

}  // namespace
}  // namespace palpate
