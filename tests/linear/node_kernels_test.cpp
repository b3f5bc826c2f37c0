#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "linear/bent_beam.h"
#include "linear/mixed_precision/node_kernels.h"
#include "linear/mixed_precision/node_order.h"
#include "linear/mixed_precision/row_packing.h"

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
    // the row's diagonal block first
    std::rotate(row, source.begin() + diagonal[i], source.begin() + diagonal[i] + 1);
  }
  std::vector<int> column;
  for (const int slot : source) column.push_back(A.body.columns()[static_cast<std::size_t>(slot)]);
  std::vector<int> row_start(A.body.row_start().begin(), A.body.row_start().end());
  linear::NodeOrder order = linear::cluster_nodes(A.body, 3, 3);
  // parts of nodes in their given order: many blocks between parts
  for (std::size_t i = 0; i < n; ++i) order.node[i] = static_cast<int>(i);
  linear::RowPacking packing;
  packing.analyse(order, row_start, column);
  std::vector<double> v(4 * n + linear::kVectorTail), Av(v);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t a = 0; a < 3; ++a) v[4 * i + a] = b[static_cast<Eigen::Index>(3 * i + a)];
  VecX exact;
  A.multiply(b, exact);
  for (int limit = 0; limit <= 2; ++limit) {
    const linear::NodeKernels& k = linear::node_kernels(limit);
    std::vector<float> values(9 * (source.size() + 1) + linear::kBlockTail), p(4 * n + linear::kVectorTail),
        q(p), inverse(static_cast<std::size_t>(linear::inverse_place(static_cast<int>(n) + 3)));
    const linear::DoubleBlocks D{row_start.data(), column.data(), source.data(), A.body.values().data(),
                                 A.body.slot_count() - 1};
    ASSERT_TRUE(k.convert(D, 1.0, values.data(), 0, static_cast<int>(n)));
    k.multiply_double(D, v.data(), Av.data(), 0, static_cast<int>(n));
    for (std::size_t i = 0; i < v.size(); ++i) p[i] = static_cast<float>(v[i]);
    std::vector<int> offset(packing.places() + linear::kLanesOfGroup * linear::kStepsAhead,
                            9 * static_cast<int>(source.size()));
    std::vector<std::uint16_t> transposed(packing.places() / linear::kLanesOfGroup, 0);
    for (std::size_t s = 0; s < source.size(); ++s)
      if (!packing.transposed(s)) offset[packing.place(s)] = 9 * static_cast<int>(s);
    double pq = 0.0;
    for (std::size_t part = 0; part < 3; ++part)
      k.pack(packing.rows(part, nullptr), {values.data(), offset.data(), nullptr});
    for (std::size_t part = 0; part < 3; ++part)
      pq += k.product(packing.rows(part, nullptr), p.data(), q.data());
    ASSERT_TRUE(k.invert_diagonal(A.body.values().data(), diagonal.data(), 1.0, inverse.data(), 0,
                                  static_cast<int>(n)));
    const auto lacks_held_columns = [&](std::size_t i) {
      return beam.rest[static_cast<Eigen::Index>(3 * i)] < -0.5 + 0.2;
    };
    const auto off_identity = [&](bool zero_row_sum) {
      double most = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        if (zero_row_sum && lacks_held_columns(i)) continue;
        const Mat3 own = Eigen::Map<const Mat3>(A.body.block(diagonal[i]));
        Mat3 J;
        for (int c = 0; c < 3; ++c)
          for (int r = 0; r < 3; ++r)
            J(r, c) = inverse[static_cast<std::size_t>(linear::inverse_place(static_cast<int>(i)) +
                                                       (r == c ? r : linear::kToOffDiagonal + 3 - r - c))];
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

    // Zero row sums: a row's deficit is its mass. Blocks occur transposed and untransposed.
    std::vector<double> mass(4 * n + linear::kVectorTail);
    std::vector<float> mass_single(mass.size());
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t a = 0; a < 3; ++a) {
        double sum = 0.0;
        for (int s = A.body.row_start()[i]; s < A.body.row_start()[i + 1]; ++s)
          sum += A.body.columns()[static_cast<std::size_t>(s)] == static_cast<int>(i)
                     ? A.body.block(s)[4 * a]
                     : static_cast<float>(A.body.block(s)[4 * a]);
        mass[4 * i + a] = sum;
        mass_single[4 * i + a] = static_cast<float>(sum);
      }
    for (std::size_t s = 0; s < source.size(); ++s) {
      const std::size_t at = packing.place(s);
      if (packing.transposed(s) || at % 3 != 0 ||
          column[s] ==
              static_cast<int>(std::upper_bound(row_start.begin(), row_start.end(), static_cast<int>(s)) -
                               row_start.begin()) -
                  1)
        continue;
      Eigen::Map<Eigen::Matrix3f>(values.data() + 9 * s).transposeInPlace();
      transposed[at / linear::kLanesOfGroup] = static_cast<std::uint16_t>(
          transposed[at / linear::kLanesOfGroup] | 1u << at % linear::kLanesOfGroup);
    }
    std::vector<float> sums(8 * n + linear::kVectorTail), Vs[5], AVs[5];
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
      const linear::PackedRows rows = packing.rows(part, mass_single.data());
      ASSERT_EQ(k.complete(rows, {values.data(), offset.data(), transposed.data()}, sums.data(),
                           inverse.data(), &trace, static_cast<int>(part) + 3, V, AV),
                linear::RowStatus::kOk);
      all_traces += trace;
    }
    pq = 0.0;
    for (std::size_t part = 0; part < 3; ++part) {
      const linear::PackedRows rows = packing.rows(part, mass_single.data());
      k.multiply_zero_row_sum(rows, mass.data(), 1.0, v.data(), Av.data());
      pq += k.product(rows, p.data(), q.data());
    }
    double off = 0.0, off_single = 0.0, off_columns = 0.0, traces = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      traces += Eigen::Map<const Mat3>(A.body.block(diagonal[i])).trace();
      if (lacks_held_columns(i)) continue;  // rows that lack columns of held nodes do not sum to their mass
      for (std::size_t a = 0; a < 3; ++a) {
        const double want = exact[static_cast<Eigen::Index>(3 * i + a)];
        off = std::max(off, std::abs(Av[4 * i + a] - want));
        off_single = std::max(off_single, std::abs(q[4 * i + a] - want));
        for (std::size_t c = 0; c < 3; ++c)
          off_columns =
              std::max(off_columns, std::abs(AVs[c][4 * i + a] / static_cast<double>(c + 1) - want));
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
      for (int j = 0; j < size; ++j)
        E[static_cast<std::size_t>(i * stride + j)] = static_cast<float>(S(i, j));
    }
    ASSERT_TRUE(k.invert(E.data(), size, stride));
    k.dense(E.data(), stride, y.data(), w.data(), 0, size);
    for (int i = 0; i < size; ++i) EXPECT_NEAR(w[static_cast<std::size_t>(i)], 1.0, 1e-3) << k.name;
  }
}

// Vector operations at the start of a solve against plain sums in double, over arbitrary ranges, for every
// instruction set.
TEST(NodeKernels, VectorsOfAStartAreThoseOfPlainSums) {
  constexpr int kNodes = 37, kFirst = 3, kLast = 36, kCount = 3, kNumbers = 4 * kNodes + linear::kVectorTail;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> number(-1.0f, 1.0f);
  const auto field = [&](auto zero) {
    std::vector<decltype(zero)> v(kNumbers, zero);
    for (std::size_t i = 0; i < 4 * kNodes; ++i)
      if (i % 4 != 3) v[i] = number(random);
    return v;
  };
  const std::vector<std::vector<float>> V{field(0.0f), field(0.0f), field(0.0f)},
      AV{field(0.0f), field(0.0f), field(0.0f)};
  const std::vector<double> b = field(0.0), Ax = field(0.0);
  const std::vector<float> d = field(0.0f), p = field(0.0f);
  const float *at_V[kCount] = {V[0].data(), V[1].data(), V[2].data()},
              *at_AV[kCount] = {AV[0].data(), AV[1].data(), AV[2].data()};
  const double y[kCount] = {0.5, -2.0, 3.0};
  const auto combined = [&](const std::vector<std::vector<float>>& of, std::size_t i) {
    return y[0] * of[0][i] + y[1] * of[1][i] + y[2] * of[2][i];
  };
  std::vector<int> node(kNodes);
  for (int k = 0; k < kNodes; ++k) node[static_cast<std::size_t>(k)] = (5 * k + 2) % kNodes;
  constexpr std::size_t kBegin = 4 * kFirst, kEnd = 4 * kLast;
  for (int limit = 0; limit <= 2; ++limit) {
    const linear::NodeKernels& k = linear::node_kernels(limit);
    SCOPED_TRACE(k.name);
    double sums[linear::kMostSums] = {}, want[10] = {};
    k.gram(kCount, y, at_V, at_AV, b.data(), kFirst, kLast, sums);
    for (std::size_t i = kBegin; i < kEnd; ++i) {
      int at = 0;
      for (std::size_t j = 0; j < kCount; ++j)
        for (std::size_t l = 0; l <= j; ++l) want[at++] += static_cast<double>(V[j][i]) * AV[l][i];
      for (std::size_t j = 0; j < kCount; ++j) want[at++] += V[j][i] * b[i];
      want[at] += std::pow(b[i] - combined(AV, i), 2);
    }
    for (int at = 0; at < 10; ++at) EXPECT_NEAR(sums[at], want[at], 1e-12 * kEnd) << at;

    std::vector<double> x(kEnd - kBegin), image(x), out(3 * kNodes, 7.0), added(x);
    std::vector<float> r(kNumbers, 9.0f), from_all(r), difference[2] = {V[0], V[1]};
    float* differences[2] = {difference[0].data(), difference[1].data()};
    k.combine(kCount, y, at_V, x.data(), kFirst, kLast);
    k.leave(kCount, y, 0.25, at_AV, b.data(), r.data(), kFirst, kLast);
    k.residual(0.25, b.data(), Ax.data(), from_all.data(), kFirst, kLast);
    k.image(0.25, b.data(), d.data(), image.data(), kFirst, kLast);
    const double largest = k.scatter_nodes(node.data(), x.data(), out.data(), kFirst, kLast);
    k.difference(2, 4.0, 0.5, x.data(), differences, kFirst, kLast);
    added = x;
    k.add_nodes(node.data(), out.data(), added.data(), kFirst, kLast);
    const std::vector<double> before = x;
    k.correct(0.25, d.data(), 3.0f, p.data(), x.data(), kFirst, kLast);
    double most = 0.0;
    for (std::size_t i = kBegin; i < kEnd; ++i) {
      const std::size_t here = i - kBegin;
      EXPECT_NEAR(before[here], combined(V, i), 1e-14) << i;
      EXPECT_NEAR(r[i], 0.25 * (b[i] - combined(AV, i)), 1e-6) << i;
      EXPECT_NEAR(from_all[i], 0.25 * (b[i] - Ax[i]), 1e-7) << i;
      EXPECT_NEAR(image[here], b[i] - 0.25 * d[i], 1e-14) << i;
      EXPECT_NEAR(x[here], before[here] + 0.25 * (d[i] + 3.0 * p[i]), 1e-6) << i;
      EXPECT_NEAR(difference[0][i], 4.0 * before[here], 1e-5) << i;
      EXPECT_NEAR(difference[1][i], 4.0 * before[here] - 0.5 * V[0][i], 1e-5) << i;
      EXPECT_EQ(added[here], 2.0 * before[here]) << i;
      if (i % 4 != 3) {
        EXPECT_EQ(out[3 * static_cast<std::size_t>(node[i / 4]) + i % 4], before[here]) << i;
      }
      most = std::max(most, std::abs(before[here]));
    }
    EXPECT_EQ(largest, most);
    EXPECT_EQ(std::count(out.begin(), out.end(), 7.0), 3 * (kNodes - (kLast - kFirst)))
        << "others are left alone";
    EXPECT_EQ(r[kBegin - 1], 9.0f);
    EXPECT_EQ(r[kEnd], 9.0f);

    // z + motion, with and without a previous direction
    std::vector<float> arm(kNumbers, 0.0f), z = field(0.0f), first_d(d), first_p(p), next_d(d), next_p(p);
    for (std::size_t i = 0; i < 4 * kNodes; ++i) arm[i] = i % 4 == 3 ? 1.0f : number(random);
    const float motion[6] = {1.0f, 2.0f, 3.0f, 0.5f, -0.25f, 0.75f};
    k.first_direction(z.data(), arm.data(), motion, first_d.data(), first_p.data(), kFirst, kLast);
    k.direction(2.0f, -0.5f, z.data(), arm.data(), motion, next_d.data(), next_p.data(), kFirst, kLast);
    for (std::size_t n = kFirst; n < kLast; ++n) {
      const Eigen::Vector3f a = Eigen::Map<const Eigen::Vector3f>(arm.data() + 4 * n),
                            turn(motion[3], motion[4], motion[5]), moved = turn.cross(a);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t i = 4 * n + axis;
        const float rigid = z[i] + motion[axis] + moved[static_cast<Eigen::Index>(axis)];
        EXPECT_EQ(first_d[i], 0.0f);
        EXPECT_NEAR(first_p[i], rigid, 1e-5) << i;
        EXPECT_NEAR(next_d[i], d[i] + 2.0f * p[i], 1e-6) << i;
        EXPECT_NEAR(next_p[i], rigid - 0.5f * p[i], 1e-5) << i;
      }
    }
    k.first_direction(z.data(), nullptr, nullptr, first_d.data(), first_p.data(), kFirst, kLast);
    EXPECT_TRUE(std::equal(z.begin() + kBegin, z.begin() + kEnd, first_p.begin() + kBegin));
  }
}

}  // namespace
}  // namespace palpate
