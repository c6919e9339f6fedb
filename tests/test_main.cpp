// Entry point of every Catch2 test program.
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>

// ThreadSanitizer of GCC does not understand the fences that order the recording queue's own indices and elements
// (-Wtsan says so); everything around the queue, LastRows above all, is checked.
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() { return "race:moodycamel::ReaderWriterQueue\n"; }
