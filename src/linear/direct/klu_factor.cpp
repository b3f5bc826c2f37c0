#include <klu.h>

#include "linear/direct/blas_memory.h"
#include "linear/direct/direct_solver.h"
#include "linear/direct/transposed_columns.h"
#include "linear/make.h"
#include "palpate/core/error.h"

namespace palpate::linear {
namespace {

using dynamics::BlockSparse;
using dynamics::SolveStatus;

/// A pivot order is kept for new values while its growth stays within this factor of what it was when the
/// order was chosen.
constexpr double kGrowthKept = 0.1;

/// Left-looking sparse LU with partial pivoting inside the blocks of a triangular form (Davis and Palamadai
/// Natarajan 2010), ordered by AMD; rows scaled by their largest entry.
/// New values go through the pivot order of the last full factorisation: no search, no graph traversal.  What
/// an order of other values can do wrong is growth, so the reciprocal pivot growth  min_j max_i |a_ij| /
/// max_i |u_ij|  is computed after each; where it has fallen by ten (a digit of the answer is gone), or a
/// pivot is zero, pivots are chosen afresh.
class KluFactor final : public BodyFactor {
 public:
  KluFactor() { klu_defaults(&common_); }
  ~KluFactor() override { release(); }
  KluFactor(const KluFactor&) = delete;
  KluFactor& operator=(const KluFactor&) = delete;

  void analyse(const BlockSparse& A) override {
    columns_ = TransposedColumns(A);
    release();
    symbolic_ = klu_analyze(columns_.n, columns_.start.data(), columns_.rows.data(), &common_);
    require("klu_analyze");
  }

  SolveStatus factor(const BlockSparse& A) override {
    columns_.fill(A);
    if (numeric_ && refactor()) return SolveStatus::kOk;
    klu_free_numeric(&numeric_, &common_);
    numeric_ =
        klu_factor(columns_.start.data(), columns_.rows.data(), columns_.values.data(), symbolic_, &common_);
    require("klu_factor");
    if (!numeric_ || common_.status == KLU_SINGULAR) return forget();
    chosen_growth_ = growth();
    return regular() ? SolveStatus::kOk : forget();
  }

  void solve(const ConstColumns& B, MatX& X) override {
    X = B;
    klu_tsolve(symbolic_, numeric_, static_cast<int>(X.rows()), static_cast<int>(X.cols()), X.data(),
               &common_);
    require("klu_tsolve");
  }

 private:
  bool refactor() {
    klu_refactor(columns_.start.data(), columns_.rows.data(), columns_.values.data(), symbolic_, numeric_,
                 &common_);
    require("klu_refactor");
    return common_.status == KLU_OK && growth() >= kGrowthKept * chosen_growth_ && regular();
  }
  double growth() {
    klu_rgrowth(columns_.start.data(), columns_.rows.data(), columns_.values.data(), symbolic_, numeric_,
                &common_);
    return common_.rgrowth;
  }
  bool regular() {
    klu_rcond(symbolic_, numeric_, &common_);
    return common_.rcond >= kSmallestPivotRatio;
  }
  SolveStatus forget() {
    klu_free_numeric(&numeric_, &common_);
    return SolveStatus::kSingular;
  }
  void release() {
    klu_free_numeric(&numeric_, &common_);
    klu_free_symbolic(&symbolic_, &common_);
  }

  void require(const char* call) const {
    if (common_.status >= KLU_OK) return;
    if (common_.status == KLU_OUT_OF_MEMORY || common_.status == KLU_TOO_LARGE)
      fail_without_memory(call, static_cast<double>(columns_.n));
    PALPATE_CHECK(false, "{} returned status {}", call, common_.status);
  }

  klu_common common_{};
  klu_symbolic* symbolic_ = nullptr;
  klu_numeric* numeric_ = nullptr;
  double chosen_growth_ = 0.0;
  TransposedColumns columns_;
};

}  // namespace

std::unique_ptr<dynamics::LinearSolver> make_klu(const IntegratorSpec&) {
  return std::make_unique<DirectSolver>("klu", true, std::make_unique<KluFactor>());
}

}  // namespace palpate::linear
