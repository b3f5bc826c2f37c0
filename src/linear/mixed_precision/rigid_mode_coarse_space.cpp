#include "linear/mixed_precision/rigid_mode_coarse_space.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

namespace palpate::linear {
namespace {

/// Returns the number of the run that each member belongs to, for runs given by a list of starts.
std::vector<int> run_of_each(const std::vector<int>& start) {
  std::vector<int> run(static_cast<std::size_t>(start.back()));
  for (std::size_t k = 0; k + 1 < start.size(); ++k)
    std::fill(run.begin() + start[k], run.begin() + start[k + 1], static_cast<int>(k));
  return run;
}

/// Centre and size of a set of nodes.
struct MeanBall {
  Vec3 centre = Vec3::Zero();
  double radius = 0.0;  ///< root mean square distance from the centre
};

Eigen::Matrix3f skew(const Eigen::Vector3f& a) {
  Eigen::Matrix3f m;
  m << 0.0f, -a.z(), a.y(), a.z(), 0.0f, -a.x(), -a.y(), a.x(), 0.0f;
  return m;
}

/// Returns a regularised diagonal entry. A direction in which no node moves (a cluster held entirely, a
/// rotation without arms) is decoupled; a tiny share of the diagonal covers rounding in the rotation of a
/// cluster whose nodes are collinear.
float regular(float own) { return own > 0.0f ? own * (1.0f + 1e-5f) : 1.0f; }

}  // namespace

void RigidModeCoarseSpace::prepare(const NodeOrder& order) {
  ready_ = false;
  finer_ = order.pieces() > order.clusters();
  size_ = 6 * order.clusters();
  stride_ = (size_ + 15) / 16 * 16;
  cluster_ = run_of_each(order.start);
  piece_ = run_of_each(order.piece_start);
  pieces_.assign(static_cast<std::size_t>(order.pieces()), {});
  arm_.assign(4 * order.node.size() + kVectorTail, 0.0f);
  E_.assign(static_cast<std::size_t>(size_) * static_cast<std::size_t>(stride_), 0.0f);
}

/// Arms are scaled by the piece's mean radius, and pieces by the cluster's, so that rows of forces and of
/// moments are of similar magnitude.
void RigidModeCoarseSpace::place_arms(const NodeOrder& order, const double* positions) {
  const auto position = [&](int k) -> Vec3 {
    return positions
               ? Vec3(Eigen::Map<const Vec3>(
                     positions + 3 * static_cast<std::ptrdiff_t>(order.node[static_cast<std::size_t>(k)])))
               : Vec3::Zero();
  };
  const auto around = [&](int first, int last) {
    MeanBall ball;
    for (int k = first; k < last; ++k) ball.centre += position(k) / (last - first);
    double square = 0.0;
    for (int k = first; k < last; ++k) square += (position(k) - ball.centre).squaredNorm() / (last - first);
    ball.radius = std::isfinite(square) ? std::sqrt(square) : 0.0;
    return ball;
  };
  for (std::size_t c = 0; c + 1 < order.start.size(); ++c) {
    const MeanBall cluster = around(order.start[c], order.start[c + 1]);
    for (auto p = static_cast<std::size_t>(order.piece[c]); p < static_cast<std::size_t>(order.piece[c + 1]);
         ++p) {
      const int first = order.piece_start[p], last = order.piece_start[p + 1];
      const MeanBall piece = finer_ ? around(first, last) : cluster;
      const double by = piece.radius > 0.0 ? 1.0 / piece.radius : 0.0,
                   in_cluster = cluster.radius > 0.0 ? 1.0 / cluster.radius : 0.0;
      pieces_[p].offset = (in_cluster * (piece.centre - cluster.centre)).cast<float>();
      pieces_[p].radius = static_cast<float>(in_cluster * piece.radius);
      for (int k = first; k < last; ++k) {
        const Vec3 arm = by > 0.0 ? Vec3(by * (position(k) - piece.centre)) : Vec3::Zero();
        float* to = arm_.data() + 4 * static_cast<std::ptrdiff_t>(k);
        for (int axis = 0; axis < 3; ++axis) to[axis] = static_cast<float>(arm[axis]);
        to[3] = 1.0f;
      }
    }
  }
}

Eigen::Vector3f RigidModeCoarseSpace::arm_in_cluster(std::size_t node) const {
  const Piece& piece = pieces_[static_cast<std::size_t>(piece_[node])];
  return piece.offset + piece.radius * Eigen::Map<const Eigen::Vector3f>(arm_.data() + 4 * node);
}

/// Excludes held nodes. The row of a held direction is the identity's: a node without coupling along some
/// axis moves with no cluster.
void RigidModeCoarseSpace::skip_held(const SingleMatrix& A) {
  const auto leave_out = [&](std::size_t node) {
    std::fill_n(arm_.begin() + 4 * static_cast<std::ptrdiff_t>(node), 4, 0.0f);
  };
  for (const std::size_t entry : A.held()) leave_out(entry / 4);
  for (std::size_t i = 0; i < cluster_.size(); ++i) {
    std::array<float, 3> coupling{};
    for (int s = A.row_start()[i] + 1; s < A.row_start()[i + 1]; ++s)
      for (int k = 0; k < 9; ++k)
        coupling[static_cast<std::size_t>(k % 3)] +=
            std::abs(A.packing().entry(static_cast<std::size_t>(s), k % 3, k / 3));
    if (*std::min_element(coupling.begin(), coupling.end()) == 0.0f) leave_out(i);
  }
}

/// E_IJ = sum over i in I, j in J of T_i^T A_ij T_j with T_i = [I, -[arm_i]x]: for each row first G = sum_j
/// A_ij T_j, then T_i^T G. The blocks of D are computed in the same way, with arms about the piece's centre.
void RigidModeCoarseSpace::assemble(const SingleMatrix& A) {
  const std::vector<int>&row_start = A.row_start(), &column = A.column();
  using Single3 = Eigen::Matrix3f;
  const auto add = [](const Single3& turn, const Single3& force, const Single3& moment, auto&& sum) {
    sum.template topLeftCorner<3, 3>() += force;
    sum.template topRightCorner<3, 3>() += moment;
    sum.template bottomLeftCorner<3, 3>().noalias() += turn * force;
    sum.template bottomRightCorner<3, 3>().noalias() += turn * moment;
  };
  std::fill(E_.begin(), E_.end(), 0.0f);
  for (Piece& piece : pieces_) piece.inverse.setZero();
  for (std::size_t i = 0; i < cluster_.size(); ++i) {
    if (arm_[4 * i + 3] == 0.0f) continue;
    const int I = cluster_[i];
    Single3 own_force = Single3::Zero(), own_moment = Single3::Zero();
    for (int s = row_start[i]; s < row_start[i + 1];) {
      const int J = cluster_[static_cast<std::size_t>(column[static_cast<std::size_t>(s)])];
      Single3 force = Single3::Zero(), moment = Single3::Zero();
      for (; s < row_start[i + 1] &&
             cluster_[static_cast<std::size_t>(column[static_cast<std::size_t>(s)])] == J;
           ++s) {
        const auto j = static_cast<std::size_t>(column[static_cast<std::size_t>(s)]);
        if (arm_[4 * j + 3] == 0.0f) continue;
        Single3 block;
        for (int k = 0; k < 9; ++k)
          block(k % 3, k / 3) = A.packing().entry(static_cast<std::size_t>(s), k % 3, k / 3);
        force += block;
        moment.noalias() -= block * skew(arm_in_cluster(j));
        if (!finer_ || piece_[j] != piece_[i]) continue;
        own_force += block;
        own_moment.noalias() -= block * skew(Eigen::Map<const Eigen::Vector3f>(arm_.data() + 4 * j));
      }
      if (J < I) continue;  // the other triangle is copied below
      add(skew(arm_in_cluster(i)), force, moment,
          Eigen::Map<Eigen::Matrix<float, 6, 6, Eigen::RowMajor>, 0, Eigen::OuterStride<>>(
              E_.data() + static_cast<std::size_t>(6 * I) * static_cast<std::size_t>(stride_) +
                  static_cast<std::size_t>(6 * J),
              Eigen::OuterStride<>(stride_)));
    }
    if (finer_)
      add(skew(Eigen::Map<const Eigen::Vector3f>(arm_.data() + 4 * i)), own_force, own_moment,
          pieces_[static_cast<std::size_t>(piece_[i])].inverse);
  }
  add_points(A.points());
  for (std::size_t r = 0; r < static_cast<std::size_t>(size_); ++r)
    for (std::size_t c = r / 6 * 6 + 6; c < static_cast<std::size_t>(size_); ++c)
      E_[c * static_cast<std::size_t>(stride_) + r] = E_[r * static_cast<std::size_t>(stride_) + c];
}

/// Adds the stiffness of contact between clusters and between pieces: its blocks, as for the blocks of the
/// matrix.
void RigidModeCoarseSpace::add_points(const PointOperator& points) {
  using Block = Eigen::Matrix<float, 6, 6>;
  const auto block_of = [](const Eigen::Vector3f& arm_i, const Eigen::Matrix3f& C,
                           const Eigen::Vector3f& arm_j) {
    const Eigen::Matrix3f turn = skew(arm_i), moment = -C * skew(arm_j);
    Block out;
    out << C, moment, turn * C, turn * moment;
    return out;
  };
  points.for_each_block([&](int place_i, int place_j, const Eigen::Matrix3f& C) {
    const auto i = static_cast<std::size_t>(place_i), j = static_cast<std::size_t>(place_j);
    if (arm_[4 * i + 3] == 0.0f || arm_[4 * j + 3] == 0.0f) return;
    if (cluster_[j] >= cluster_[i])
      Eigen::Map<Eigen::Matrix<float, 6, 6, Eigen::RowMajor>, 0, Eigen::OuterStride<>>(
          E_.data() + static_cast<std::size_t>(6 * cluster_[i]) * static_cast<std::size_t>(stride_) +
              static_cast<std::size_t>(6 * cluster_[j]),
          Eigen::OuterStride<>(stride_)) += block_of(arm_in_cluster(i), C, arm_in_cluster(j));
    if (finer_ && piece_[i] == piece_[j])
      pieces_[static_cast<std::size_t>(piece_[i])].inverse +=
          block_of(Eigen::Map<const Eigen::Vector3f>(arm_.data() + 4 * i), C,
                   Eigen::Map<const Eigen::Vector3f>(arm_.data() + 4 * j));
  });
}

void RigidModeCoarseSpace::invert_pieces() {
  for (Piece& piece : pieces_) {
    Eigen::Matrix<double, 6, 6> D = piece.inverse.cast<double>();
    for (int k = 0; k < 6; ++k) D(k, k) = regular(piece.inverse(k, k));
    const Eigen::LLT<Eigen::Matrix<double, 6, 6>> llt(D);
    if (llt.info() == Eigen::Success)
      piece.inverse = llt.solve(Eigen::Matrix<double, 6, 6>::Identity()).cast<float>();
    else
      piece.inverse.setZero();  // this piece has no correction apart from its cluster's
    piece.inverse = (0.5f * (piece.inverse + piece.inverse.transpose())).eval();
  }
}

bool RigidModeCoarseSpace::refresh(const SingleMatrix& A, const double* positions,
                                   const NodeKernels& kernels) {
  place_arms(A.order(), positions);
  skip_held(A);
  assemble(A);
  if (finer_) invert_pieces();
  for (std::size_t k = 0; k < static_cast<std::size_t>(size_); ++k) {
    float& own = E_[k * static_cast<std::size_t>(stride_) + k];
    own = regular(own);
  }
  scale_ = A.scale();
  return ready_ = kernels.invert(E_.data(), size_, stride_);
}

void RigidModeCoarseSpace::serve(double scale) {
  if (!ready_ || scale == scale_) return;
  const auto by = static_cast<float>(scale_ / scale);  // a power of two
  for (float& value : E_) value *= by;
  for (Piece& piece : pieces_) piece.inverse *= by;
  scale_ = scale;
}

double RigidModeCoarseSpace::gather(std::size_t cluster, const NodeOrder& order, const NodeKernels& kernels,
                                    const float* r, float* of_pieces, float* of_cluster) const {
  Eigen::Map<Six> sum(of_cluster);
  sum.setZero();
  double share = 0.0;
  for (auto p = static_cast<std::size_t>(order.piece[cluster]);
       p < static_cast<std::size_t>(order.piece[cluster + 1]); ++p) {
    const Piece& piece = pieces_[p];
    Eigen::Map<Six> own(of_pieces + 6 * p);
    kernels.gather_rigid(r, arm(), own.data(), order.piece_start[p], order.piece_start[p + 1]);
    const Eigen::Vector3f force = own.head<3>();
    sum.head<3>() += force;
    sum.tail<3>() += piece.radius * own.tail<3>() + piece.offset.cross(force);
    if (!finer_) continue;
    const Six solved = piece.inverse * own;
    share += (own.cast<double>().array() * solved.cast<double>().array()).sum();
    own = solved;
  }
  return share;
}

RigidModeCoarseSpace::Six RigidModeCoarseSpace::motion(std::size_t p, const float* own,
                                                       const float* of_cluster) const {
  const Piece& piece = pieces_[p];
  const Eigen::Map<const Six> cluster(of_cluster);
  Six motion;
  motion.head<3>() = cluster.head<3>() + Eigen::Vector3f(cluster.tail<3>()).cross(piece.offset);
  motion.tail<3>() = piece.radius * cluster.tail<3>();
  if (finer_) motion += Eigen::Map<const Six>(own);
  return motion;
}

}  // namespace palpate::linear
