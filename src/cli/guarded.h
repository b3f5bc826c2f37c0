#pragma once
#include <functional>

namespace palpate::cli {

/// Runs a command of a program.  Every way out has one sentence on standard error and one exit status: those
/// of stop.h.  An error of the system (a folder that is not there, a loop of links, no more threads) is said
/// as the system says it; what else ends a command without a sentence of its own is a defect of palpate.
/// @param input  what a report of such a defect should bring: "scene"
int guarded(const std::function<int()>& action, const char* input);

}  // namespace palpate::cli
