// Instruction sets may be specified by a user, and a processor may lack them.
#include "core/instructions.h"

#include <gtest/gtest.h>

#include "palpate/core/error.h"

using palpate::choose_instructions;
using palpate::Instructions;

namespace {

std::string refusal(const char* requested, Instructions widest) {
  try {
    choose_instructions(requested, widest);
  } catch (const palpate::Error& e) { return e.what(); }
  return "accepted";
}

TEST(Instructions, TheWidestUnlessAnotherIsNamed) {
  EXPECT_EQ(choose_instructions("", Instructions::kAvx2), Instructions::kAvx2);
  EXPECT_EQ(choose_instructions("baseline", Instructions::kAvx512), Instructions::kBaseline);
  EXPECT_EQ(choose_instructions("avx2", Instructions::kAvx512), Instructions::kAvx2);
  EXPECT_EQ(choose_instructions("avx512", Instructions::kAvx512), Instructions::kAvx512);
}

TEST(Instructions, WhatTheProcessorLacksIsRefusedWithWhatItHas) {
  EXPECT_EQ(refusal("avx512", Instructions::kAvx2),
            "PALPATE_INSTRUCTIONS = \"avx512\": this processor does not support it; set it to one of "
            "baseline, avx2, or unset it");
  EXPECT_EQ(refusal("avx2", Instructions::kBaseline),
            "PALPATE_INSTRUCTIONS = \"avx2\": this processor does not support it; set it to one of baseline, "
            "or unset it");
  EXPECT_EQ(refusal("sse9", Instructions::kAvx2),
            "PALPATE_INSTRUCTIONS = \"sse9\": unknown instruction set; set it to one of baseline, avx2, or "
            "unset it");
}

}  // namespace
