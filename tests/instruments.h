// What a test need not repeat under sanitizers or valgrind, where everything takes many times as long.
#pragma once

namespace springstab::test {

/// How often to go through the same code with other numbers: `many` times, or `few` where what counts is that
/// each line is seen by an instrument.
template <class Count>
constexpr Count times([[maybe_unused]] Count many, [[maybe_unused]] Count few) {
#ifdef SPRINGSTAB_INSTRUMENTED
  return few;
#else
  return many;
#endif
}

}  // namespace springstab::test
