// Measures errors at the extremes against exact arithmetic.
#include <iostream>
#include <string>
#include <vector>

#include "stability_command.h"

int main(int count, char** words) {
  return organ_collision::tools::measureStability(
      std::vector<std::string>(words + 1, words + count), std::cout, std::cerr);
}
