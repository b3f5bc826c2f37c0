#pragma once
#include <string>
#include <vector>

#include "report/answer.h"
#include "report/table.h"
#include "report/work_precision.h"

/// Results of a comparison as sentences.
namespace palpate::report {

/// Returns whether the error of the force on the hand can be judged: it is measured, and the peak of the
/// reference is not rounding.
bool has_force(const Table& compare, const ReferenceError& reference);

/// Returns sentences on which method is cheapest at each target error, with its margin, for positions and, if
/// present, for the force on the hand.
std::vector<Answer> cheapest_in_words(const Table& compare, const ReferenceError& reference);

/// Returns remarks on the limits of these answers, one paragraph per remark: which methods failed and why,
/// which explicit methods are at their stability limit, and whether the reference is accurate enough.
std::vector<std::string> remarks_in_words(const Table& compare, const ReferenceError& reference);

/// Returns the results as sentences: which method is cheapest at each target, for positions and for the force
/// on the hand, which failed and why, which explicit methods are at their stability limit, and whether the
/// reference is accurate enough. Paragraphs are separate lines.
std::string in_words(const Table& compare, const ReferenceError& reference);

}  // namespace palpate::report
