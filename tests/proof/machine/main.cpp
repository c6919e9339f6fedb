// proof_machine [COMMANDS]: a scenario on standard input, its recording as CSV on standard output; COMMANDS holds one
// command a line, in the place of the loop's.
#include "recorder.hpp"

#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>

int main(int count, char** words) {
  try {
    const proof::Scenario scenario = proof::read_scenario(std::cin);
    std::ios::sync_with_stdio(false);
    std::vector<double> commands;
    if (count > 1) {
      std::ifstream file(words[1]);
      for (double volt = 0.0; file >> volt;) commands.push_back(volt);
      if (commands.empty()) throw std::runtime_error(std::string(words[1]) + ": no commands found");
    }
    proof::record(scenario, std::cout, count > 1 ? &commands : nullptr);
    return std::cout.flush() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "proof_machine: " << error.what() << '\n';
    return 2;
  }
}
