#pragma once
#include <functional>

namespace palpate::cli {

/// Runs a command of a program and maps each way to end to one message on standard error and one exit status
/// (stop.h). An operating-system error (missing folder, loop of links, thread limit) is reported with the
/// message of the system; any other exception is reported as a defect of palpate.
/// @param input  the input that a report of a defect should include: "scene"
/// @return the exit status
int guarded(const std::function<int()>& action, const char* input);

}  // namespace palpate::cli
