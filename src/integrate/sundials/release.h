#pragma once
#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_mristep.h>
#include <cvode/cvode.h>
#include <fcntl.h>
#include <ida/ida.h>
#include <kinsol/kinsol.h>
#include <sundials/sundials_config.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_logger.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <limits>
#include <string>
#include <string_view>

#include "integrate/sundials/hidden.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"

// Everything in which the tested releases of SUNDIALS differ: 6.4 (Debian 12) and 7.1 (Debian 13).  All other
// files use names and meanings that both have.
#define PALPATE_SUNDIALS_7 (SUNDIALS_VERSION_MAJOR >= 7)

// 7.1 has one ARKodeSet.. for each ARKStepSet.. and MRIStepSet.., and marks the latter as deprecated, which
// are the only ones that 6.4 has.
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// SUN_NLS_SUCCESS, SUNLS_SUCCESS and SUNMAT_SUCCESS of 6.x, which 7.0 replaced by SUN_SUCCESS.
constexpr int kSuccess = 0;

/// ARKStepSetTableNum; each step starts from f of the state that it starts from.
///
/// 7.1 takes the last stage of a stiffly accurate table (b is the last row of A) for the solution, and f of
/// that stage for the first one of the next step, where that is explicit.  The f of an implicit stage is what
/// Newton's iteration left, and neither knows of a projection in between: what a step does then depends on
/// whether the method was reset before it.  6.4 evaluates f anew in each first stage.
/// 7.1 does the same for a b that differs from the last row by more than 100 eps.  Two weights are shifted by
/// 200 eps, in opposite directions, so that sum b = 1 is kept.  The solution moves by 200 eps h (f_s -
/// f_(s-1)), less than 5e-14 of what a step changes: a twentieth of the tightest tolerance (tuning.h).
/// @param projected  a step is post-processed
/// @return  the flag of the call
inline int set_tables(void* memory, ARKODE_DIRKTableID implicit, ARKODE_ERKTableID explicit_,
                      [[maybe_unused]] bool projected) {
#if PALPATE_SUNDIALS_7
  const bool by_newton = implicit != ARKODE_DIRK_NONE;
  // The explicit half of an additive pair is not stiffly accurate.
  const bool additive = by_newton && explicit_ != ARKODE_ERK_NONE;
  ARKodeButcherTable table = additive    ? nullptr
                             : by_newton ? ARKodeButcherTable_LoadDIRK(implicit)
                                         : ARKodeButcherTable_LoadERK(explicit_);
  if (table && ARKodeButcherTable_IsStifflyAccurate(table) &&
      (projected || (by_newton && table->A[0][0] == 0.0))) {
    constexpr double kShift = 200.0 * std::numeric_limits<double>::epsilon();
    table->b[table->stages - 1] += kShift;
    table->b[table->stages - 2] -= kShift;
    const int flag = ARKStepSetTables(memory, table->q, table->p, by_newton ? table : nullptr,
                                      by_newton ? nullptr : table);
    ARKodeButcherTable_Free(table);
    return flag;
  }
  ARKodeButcherTable_Free(table);
#endif
  return ARKStepSetTableNum(memory, implicit, explicit_);
}

/// Gives MRIStep's interpolant, of dense output and of root finding, the right-hand side that the step under
/// way starts from.  To be called by its first evaluation of the slow side.
///
/// 7.0 and 7.1 evaluate the slow side there and take the memory for the sum of both sides for current, in
/// which nothing stands yet, or what stood there a step ago (mended in 7.2): a method of order 4 interpolates
/// with it (findings/sundials-7.1-mristep-interpolates-unset-memory.sh).  While it is not current an
/// interpolation evaluates it; a derivative of a higher order than the interpolant has does no more than
/// that.
/// @param t  start of the step
inline void evaluate_start([[maybe_unused]] void* memory, [[maybe_unused]] double t,
                           [[maybe_unused]] N_Vector scratch) {
#if PALPATE_SUNDIALS_7 && SUNDIALS_VERSION_MAJOR == 7 && SUNDIALS_VERSION_MINOR < 2
  MRIStepGetDky(memory, t, ARK_INTERP_MAX_DEGREE + 1, scratch);
#endif
}

enum class Solver { kCvode, kArkStep, kMriStep, kIda, kKinsol };

/// A SUNContext without MPI.  Errors of the solvers that are attached to it go to a handler, warnings to
/// palpate's log at the level `debug`; SUNDIALS itself prints nothing.
class Context {
 public:
  /// @param function  of SUNDIALS, that reports the error
  using ErrorHandler = void (*)(const char* function, const char* text, void* data);

  /// @throws InternalError where SUNDIALS makes no context
  Context(ErrorHandler handler, void* data) : handler_(handler), data_(data) {
    const int flag = SUNContext_Create(kNoCommunicator, &context_);
    PALPATE_CHECK(flag == 0, "SUNContext_Create returned flag {}", flag);
    prepare();
  }
  ~Context() {
    log_warnings();
    SUNContext_Free(&context_);
    if (warnings_ >= 0) ::close(warnings_);
  }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  operator SUNContext() const { return context_; }  // NOLINT: it stands for one

#if PALPATE_SUNDIALS_7
  // With MPI a SUNComm is MPI_Comm, a pointer in Open MPI: a null one compiles, is no communicator, and MPI
  // ends the process.
  static inline const SUNComm kNoCommunicator = SUN_COMM_NULL;

  /// Solvers report to their context.
  void attach(Solver, void*) {}

  /// Warnings pass no handler: the logger writes them to a file of a given name, standard output by default.
  /// The file is one in memory.  To be called after the calls that may warn.
  void log_warnings() {
    SUNLogger logger = nullptr;
    if (warnings_ < 0 || SUNContext_GetLogger(context_, &logger) != 0) return;
    SUNLogger_Flush(logger, SUN_LOGLEVEL_WARNING);
    std::array<char, 1024> text;
    for (ssize_t n = 0; (n = ::pread(warnings_, text.data(), text.size(), read_)) > 0; read_ += n)
      log::debug("SUNDIALS: {}", std::string_view(text.data(), static_cast<std::size_t>(n)));
  }

 private:
  void prepare() {
    // Handlers are a stack, and each is called: the first one prints to standard error.
    SUNContext_ClearErrHandlers(context_);
    SUNContext_PushErrHandler(context_, on_error, this);
    SUNLogger logger = nullptr;
    if (SUNContext_GetLogger(context_, &logger) != 0 || !logger) return;
    warnings_ = ::memfd_create("sundials-warnings", MFD_CLOEXEC);
    const std::string name = "/proc/self/fd/" + std::to_string(warnings_);
    if (warnings_ >= 0 && SUNLogger_SetWarningFilename(logger, name.c_str()) == 0) return;
    SUNLogger_SetWarningFilename(logger, "/dev/null");  // /proc is not mounted
  }
  static void on_error(int, const char* function, const char*, const char* text, SUNErrCode code, void* data,
                       SUNContext) {
    auto* me = static_cast<Context*>(data);
    me->handler_(function, text ? text : SUNGetErrMsg(code), me->data_);
  }
#else
  static constexpr void* kNoCommunicator = nullptr;

  /// Each solver has a handler, for errors and warnings.
  void attach(Solver solver, void* memory) {
    int flag = 0;
    switch (solver) {
      case Solver::kCvode: flag = CVodeSetErrHandlerFn(memory, on_report, this); break;
      case Solver::kArkStep: flag = ARKStepSetErrHandlerFn(memory, on_report, this); break;
      case Solver::kMriStep: flag = MRIStepSetErrHandlerFn(memory, on_report, this); break;
      case Solver::kIda: flag = IDASetErrHandlerFn(memory, on_report, this); break;
      case Solver::kKinsol: flag = KINSetErrHandlerFn(memory, on_report, this); break;
    }
    PALPATE_CHECK(flag == 0, "SetErrHandlerFn returned flag {}", flag);
  }
  void log_warnings() {}

 private:
  void prepare() {}
  static void on_report(int code, const char*, const char* function, char* text, void* data) {
    auto* me = static_cast<Context*>(data);
    constexpr int kWarning = 99;  // CV_WARNING, ARK_WARNING, IDA_WARNING, KIN_WARNING
    if (code == kWarning)
      log::debug("SUNDIALS: {}: {}", function, text);
    else
      me->handler_(function, text, me->data_);
  }
#endif

  ErrorHandler handler_;
  void* data_;
  SUNContext context_ = nullptr;
  int warnings_ = -1;
  ::off_t read_ = 0;
};

}  // namespace sun
}  // namespace palpate::integrate
