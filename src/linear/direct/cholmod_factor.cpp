#include <cholmod.h>

#include <utility>

#include "linear/direct/blas_memory.h"
#include "linear/direct/direct_solver.h"
#include "linear/make.h"
#include "palpate/core/error.h"

namespace palpate::linear {
namespace {

using dynamics::BlockSparse;
using dynamics::SolveStatus;

// Choice of the fill-reducing ordering. Minimum degree (AMD) is greedy, elimination by elimination; nested
// dissection (METIS) bisects the mesh recursively, costs two to three AMD analyses, and wins where separators
// are small relative to the parts that they separate: large and compact meshes. Both predict their flops
// exactly before any numeric work, so both are tried once per pattern, and the cheaper is kept. METIS orders
// the graph of the nodes, not of their directions: the same quality in two thirds of the time. Measured on
// M + h^2 K of box meshes (five tetrahedra per cell, one thread, median of 7; times as ratios within one run;
// last column: time of the METIS ordering over the time of the AMD factorisation):
//
//   body                       nodes   AMD flops / nnz(A)   flops METIS/AMD   factor METIS/AMD   order/factor
//   beam 1 x 0.25 x 0.25 m      325          150               1.5                0.8-1.0            0.9
//                             1,225          525               1.7                1.1                1.0
//                             3,700        2,700               1.2                1.0-1.1            0.7
//                             6,480        5,560               0.92               1.0-1.06           0.6
//                            11,172       11,080               0.71               0.84               0.4
//   cube                      1,000        1,210               0.94               0.7-0.85           0.7
//                             2,197        3,130               0.62               0.73-0.83          0.65
//                             4,096        7,610               0.48               0.65               0.4
//                             9,261       21,250               0.42               0.57               0.26
//
// METIS is therefore tried from kMetisFrom flops per entry on: there its ordering costs less than one AMD
// factorisation. Time falls less than flops do (AMD's large supernodes run faster): METIS is taken where it
// saves a tenth of the flops.
constexpr double kMetisFrom = 2000.0;
constexpr double kMetisTaken = 0.9;

// When contact between bodies begins, ends and rolls on, the pattern changes by a few pairs among many. The
// earlier ordering is then as good as a new one but for some fill, and costs a fraction of it. It is kept
// while the factor's flops stay below kStillGood times their number when the ordering was computed.
constexpr double kStillGood = 1.25;

/// Supernodal L L^T (Chen, Davis, Hager, Rajamanickam 2008), ordered by AMD or METIS, whichever is cheaper
/// for the mesh. Column j of the lower triangle is row j of a symmetric matrix from the diagonal on: the
/// blocks of BlockSparse are read in their stored order.
class CholmodFactor final : public BodyFactor {
 public:
  CholmodFactor() {
    cholmod_start(&common_);
    common_.print = 0;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_AMD;
    common_.postorder = 1;
    common_.quick_return_if_not_posdef = 1;
  }
  ~CholmodFactor() override {
    cholmod_free_factor(&L_, &common_);
    for (cholmod_dense** dense : {&X_, &Y_, &E_}) cholmod_free_dense(dense, &common_);
    cholmod_finish(&common_);
  }
  CholmodFactor(const CholmodFactor&) = delete;
  CholmodFactor& operator=(const CholmodFactor&) = delete;

  void analyse(const BlockSparse& A) override {
    build_map(A);
    cholmod_free_factor(&L_, &common_);
    cholmod_sparse lower = view();
    if (order_.size() == n_) {
      L_ = analyse_in(order_, lower);
      if (common_.fl <= kStillGood * flops_) return;
      cholmod_free_factor(&L_, &common_);
    }
    L_ = cholmod_analyze(&lower, &common_);
    require("cholmod_analyze");
    ordering_ = "AMD";
    flops_ = common_.fl;
    if (common_.fl >= kMetisFrom * common_.anz) try_metis(A, lower);
    const int* order = static_cast<const int*>(L_->Perm);
    order_.assign(order, order + n_);
    ++orderings_;
  }
  std::string ordering() const override { return ordering_; }
  long orderings() const override { return orderings_; }

  SolveStatus factor(const BlockSparse& A) override {
    const double* from = A.values().data();
    for (std::size_t k = 0; k < source_.size(); ++k) values_[k] = from[source_[k]];
    cholmod_sparse lower = view();
    if (L_->xtype == CHOLMOD_PATTERN)  // first factor since the analysis, which yields its size
      refuse_factor_beyond_memory(static_cast<double>(n_), sizeof(double) * static_cast<double>(L_->xsize));
    cholmod_factorize(&lower, L_, &common_);
    require("cholmod_factorize");
    return common_.status == CHOLMOD_OK && L_->minor == L_->n ? SolveStatus::kOk : SolveStatus::kIndefinite;
  }

  void solve(const ConstColumns& B, MatX& X) override {
    cholmod_dense b{};
    b.nrow = static_cast<std::size_t>(B.rows());
    b.ncol = static_cast<std::size_t>(B.cols());
    b.d = static_cast<std::size_t>(B.outerStride());
    b.nzmax = b.d * b.ncol;
    b.x = const_cast<double*>(B.data());  // read only
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    cholmod_solve2(CHOLMOD_A, L_, &b, nullptr, &X_, nullptr, &Y_, &E_, &common_);
    require("cholmod_solve2");
    X = Eigen::Map<const MatX>(static_cast<const double*>(X_->x), B.rows(), B.cols());
  }

 private:
  /// Builds the lower triangle in compressed columns, and the index of each entry in the block matrix's
  /// values.
  void build_map(const BlockSparse& A) {
    n_ = 3 * static_cast<std::size_t>(A.block_rows());
    column_start_.assign(1, 0);
    rows_.clear();
    source_.clear();
    for (int i = 0; i < A.block_rows(); ++i)
      for (int r = 0; r < 3; ++r) {
        for (int s = A.row_start()[static_cast<std::size_t>(i)];
             s < A.row_start()[static_cast<std::size_t>(i) + 1]; ++s) {
          const int j = A.columns()[static_cast<std::size_t>(s)];
          for (int c = j == i ? r : 0; j >= i && c < 3; ++c) {
            rows_.push_back(3 * j + c);
            source_.push_back(9 * s + 3 * r + c);
          }
        }
        column_start_.push_back(static_cast<int>(rows_.size()));
      }
    values_.assign(rows_.size(), 0.0);
  }

  /// Analyses the pattern with a given ordering.
  cholmod_factor* analyse_in(std::vector<int>& order, cholmod_sparse& lower) {
    common_.method[0].ordering = CHOLMOD_GIVEN;
    cholmod_factor* out = cholmod_analyze_p(&lower, order.data(), nullptr, 0, &common_);
    common_.method[0].ordering = CHOLMOD_AMD;
    require("cholmod_analyze_p");
    return out;
  }

  /// Tries METIS on the graph of the nodes; each node's three directions are ordered consecutively.
  void try_metis(const BlockSparse& A, cholmod_sparse& lower) {
    std::vector<int> start(1, 0), neighbours;
    for (int i = 0; i < A.block_rows(); ++i) {
      for (int s = A.row_start()[static_cast<std::size_t>(i)];
           s < A.row_start()[static_cast<std::size_t>(i) + 1]; ++s)
        if (const int j = A.columns()[static_cast<std::size_t>(s)]; j >= i) neighbours.push_back(j);
      start.push_back(static_cast<int>(neighbours.size()));
    }
    cholmod_sparse graph{};
    graph.nrow = graph.ncol = n_ / 3;
    graph.nzmax = neighbours.size();
    graph.p = start.data();
    graph.i = neighbours.data();
    graph.stype = -1;
    graph.itype = CHOLMOD_INT;
    graph.xtype = CHOLMOD_PATTERN;
    graph.dtype = CHOLMOD_DOUBLE;
    graph.sorted = graph.packed = 1;
    std::vector<int> nodes(n_ / 3), directions;
    cholmod_metis(&graph, nullptr, 0, 1, nodes.data(), &common_);
    require("cholmod_metis");
    for (const int node : nodes)
      for (int axis = 0; axis < 3; ++axis) directions.push_back(3 * node + axis);
    cholmod_factor* other = analyse_in(directions, lower);
    if (common_.fl < kMetisTaken * flops_) {
      std::swap(L_, other);
      ordering_ = "METIS";
      flops_ = common_.fl;
    }
    cholmod_free_factor(&other, &common_);
  }

  /// Returns a CHOLMOD view of the lower triangle; it shares this object's memory.
  cholmod_sparse view() {
    cholmod_sparse lower{};
    lower.nrow = lower.ncol = n_;
    lower.nzmax = rows_.size();
    lower.p = column_start_.data();
    lower.i = rows_.data();
    lower.x = values_.data();
    lower.stype = -1;
    lower.itype = CHOLMOD_INT;
    lower.xtype = CHOLMOD_REAL;
    lower.dtype = CHOLMOD_DOUBLE;
    lower.sorted = lower.packed = 1;
    return lower;
  }

  /// Checks the status of a library call. "Not positive definite" is a result, not a failure; other errors
  /// throw.
  void require(const char* call) const {
    if (common_.status >= CHOLMOD_OK) return;
    if (common_.status == CHOLMOD_OUT_OF_MEMORY || common_.status == CHOLMOD_TOO_LARGE)
      fail_without_memory(call, static_cast<double>(n_));
    PALPATE_CHECK(false, "{} returned status {}", call, common_.status);
  }

  cholmod_common common_{};
  cholmod_factor* L_ = nullptr;
  cholmod_dense *X_ = nullptr, *Y_ = nullptr, *E_ = nullptr;  // kept: a warm solve allocates nothing
  std::string ordering_;
  std::vector<int> order_;  ///< last computed ordering
  double flops_ = 0.0;      ///< flops of the factor at that time
  long orderings_ = 0;
  std::size_t n_ = 0;
  std::vector<int> column_start_, rows_, source_;
  std::vector<double> values_;
};

}  // namespace

std::unique_ptr<dynamics::LinearSolver> make_cholmod(const IntegratorSpec&) {
  return std::make_unique<DirectSolver>("cholmod", false, std::make_unique<CholmodFactor>());
}

}  // namespace palpate::linear
