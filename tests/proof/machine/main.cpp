// proof_machine: a scenario on standard input, its recording as CSV on standard output.
#include "recorder.hpp"

#include <exception>
#include <iostream>

int main() {
  try {
    const proof::Scenario scenario = proof::read_scenario(std::cin);
    std::ios::sync_with_stdio(false);
    proof::record(scenario, std::cout);
    return std::cout.flush() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "proof_machine: " << error.what() << '\n';
    return 2;
  }
}
