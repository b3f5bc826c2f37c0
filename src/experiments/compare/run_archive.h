#pragma once
#include "palpate/core/archive.h"
#include "palpate/loop/run.h"

namespace palpate::compare {

/// Archives the result of a run in virtual time, in a group called "result".
void archive_result(Archive& a, loop::RunResult& result);

}  // namespace palpate::compare
