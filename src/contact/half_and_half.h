#pragma once
#include <memory>

#include "palpate/contact/sample_source.h"

namespace palpate::contact {

/// Combines two sources of one pair with half of the weight each. @pre both have the same side first
std::unique_ptr<SampleSource> make_half_and_half(std::unique_ptr<SampleSource> first,
                                                 std::unique_ptr<SampleSource> second);

}  // namespace palpate::contact
