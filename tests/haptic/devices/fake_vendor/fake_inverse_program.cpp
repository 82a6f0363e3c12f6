// The replacement of the Inverse3's service as a program, for scripts: prints its address, and runs until its input ends.
#include <cstdio>

#include "tests/haptic/devices/fake_vendor/fake_inverse_service.h"

int main() {
  fettle::fake::FakeInverseService service;
  std::puts(service.address().c_str());
  std::fflush(stdout);
  while (std::getchar() != EOF) {
  }
}
