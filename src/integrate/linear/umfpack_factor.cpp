#include <umfpack.h>

#include "integrate/linear/direct_solver.h"
#include "integrate/make.h"
#include "palpate/core/error.h"

namespace palpate::integrate {
namespace {

using dynamics::BlockSparse;
using dynamics::SolveStatus;

/// Multifrontal LU with threshold pivoting (Davis 2004), symmetric strategy: the pattern is symmetric and the diagonal strong.
/// Scalar rows of BlockSparse are the compressed columns of A^T: A^T is factored, and A x = b solved as the transposed system.
class UmfpackFactor final : public BodyFactor {
 public:
  UmfpackFactor() {
    umfpack_di_defaults(control_);
    control_[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
  }
  ~UmfpackFactor() override {
    umfpack_di_free_numeric(&numeric_);
    umfpack_di_free_symbolic(&symbolic_);
  }
  UmfpackFactor(const UmfpackFactor&) = delete;
  UmfpackFactor& operator=(const UmfpackFactor&) = delete;

  void analyse(const BlockSparse& A) override {
    build_map(A);
    umfpack_di_free_numeric(&numeric_);
    umfpack_di_free_symbolic(&symbolic_);
    require(umfpack_di_symbolic(n_, n_, start_.data(), indices_.data(), nullptr, &symbolic_, control_, info_), "umfpack_di_symbolic");
  }

  SolveStatus factor(const BlockSparse& A) override {
    const double* from = A.values().data();
    for (std::size_t k = 0; k < source_.size(); ++k) values_[k] = from[source_[k]];
    umfpack_di_free_numeric(&numeric_);
    const int status = umfpack_di_numeric(start_.data(), indices_.data(), values_.data(), symbolic_, &numeric_, control_, info_);
    require(status, "umfpack_di_numeric");
    return status == UMFPACK_WARNING_singular_matrix ? SolveStatus::kSingular : SolveStatus::kOk;
  }

  void solve(const ConstColumns& B, MatX& X) override {
    X.resize(B.rows(), B.cols());
    for (Eigen::Index c = 0; c < B.cols(); ++c)
      require(umfpack_di_wsolve(UMFPACK_At, start_.data(), indices_.data(), values_.data(), X.col(c).data(), B.col(c).data(), numeric_, control_,
                                info_, integer_work_.data(), real_work_.data()), "umfpack_di_wsolve");
  }

 private:
  void build_map(const BlockSparse& A) {
    n_ = 3 * A.block_rows();
    start_.assign(1, 0);
    indices_.clear();
    source_.clear();
    for (int row = 0; row < n_; ++row) {
      for (int s = A.row_start()[static_cast<std::size_t>(row / 3)]; s < A.row_start()[static_cast<std::size_t>(row / 3) + 1]; ++s)
        for (int c = 0; c < 3; ++c) {
          indices_.push_back(3 * A.columns()[static_cast<std::size_t>(s)] + c);
          source_.push_back(9 * s + 3 * (row % 3) + c);
        }
      start_.push_back(static_cast<int>(indices_.size()));
    }
    values_.assign(indices_.size(), 0.0);
    integer_work_.resize(static_cast<std::size_t>(n_));
    real_work_.resize(5 * static_cast<std::size_t>(n_));
  }

  void require(int status, const char* call) const {
    if (status >= UMFPACK_OK) return;
    if (status == UMFPACK_ERROR_out_of_memory) fail("{}: no memory for the factor of {} unknowns; use a coarser mesh", call, n_);
    PALPATE_CHECK(false, "{} returned status {}", call, status);
  }

  double control_[UMFPACK_CONTROL];
  double info_[UMFPACK_INFO];
  void *symbolic_ = nullptr, *numeric_ = nullptr;
  int n_ = 0;
  std::vector<int> start_, indices_, source_, integer_work_;
  std::vector<double> values_, real_work_;
};

}  // namespace

std::unique_ptr<dynamics::LinearSolver> make_umfpack(const IntegratorSpec&) {
  return std::make_unique<DirectSolver>("umfpack", true, std::make_unique<UmfpackFactor>());
}

}  // namespace palpate::integrate
