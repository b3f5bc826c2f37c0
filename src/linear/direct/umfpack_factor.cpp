#include <umfpack.h>

#include "linear/direct/blas_memory.h"
#include "linear/direct/direct_solver.h"
#include "linear/direct/transposed_columns.h"
#include "linear/make.h"
#include "palpate/core/error.h"

namespace palpate::linear {
namespace {

using dynamics::BlockSparse;
using dynamics::SolveStatus;

/// Multifrontal LU with threshold pivoting (Davis 2004), symmetric strategy: the pattern is symmetric and the
/// diagonal entries are large.
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
    columns_ = TransposedColumns(A);
    integer_work_.resize(static_cast<std::size_t>(columns_.n));
    real_work_.resize(5 * static_cast<std::size_t>(columns_.n));
    umfpack_di_free_numeric(&numeric_);
    umfpack_di_free_symbolic(&symbolic_);
    require(umfpack_di_symbolic(columns_.n, columns_.n, columns_.start.data(), columns_.rows.data(), nullptr,
                                &symbolic_, control_, info_),
            "umfpack_di_symbolic");
  }

  SolveStatus factor(const BlockSparse& A) override {
    columns_.fill(A);
    umfpack_di_free_numeric(&numeric_);
    const int status = umfpack_di_numeric(columns_.start.data(), columns_.rows.data(), columns_.values.data(),
                                          symbolic_, &numeric_, control_, info_);
    require(status, "umfpack_di_numeric");
    return status == UMFPACK_WARNING_singular_matrix || info_[UMFPACK_RCOND] < kSmallestPivotRatio
               ? SolveStatus::kSingular
               : SolveStatus::kOk;
  }

  void solve(const ConstColumns& B, MatX& X) override {
    X.resize(B.rows(), B.cols());
    for (Eigen::Index c = 0; c < B.cols(); ++c)
      require(umfpack_di_wsolve(UMFPACK_At, columns_.start.data(), columns_.rows.data(),
                                columns_.values.data(), X.col(c).data(), B.col(c).data(), numeric_, control_,
                                info_, integer_work_.data(), real_work_.data()),
              "umfpack_di_wsolve");
  }

 private:
  void require(int status, const char* call) const {
    if (status >= UMFPACK_OK) return;
    if (status == UMFPACK_ERROR_out_of_memory) fail_without_memory(call, static_cast<double>(columns_.n));
    PALPATE_CHECK(false, "{} returned status {}", call, status);
  }

  double control_[UMFPACK_CONTROL];
  double info_[UMFPACK_INFO];
  void *symbolic_ = nullptr, *numeric_ = nullptr;
  TransposedColumns columns_;
  std::vector<int> integer_work_;
  std::vector<double> real_work_;
};

}  // namespace

std::unique_ptr<dynamics::LinearSolver> make_umfpack(const IntegratorSpec&) {
  return std::make_unique<DirectSolver>("umfpack", true, std::make_unique<UmfpackFactor>());
}

}  // namespace palpate::linear
