/* Shared by the examples: the models' bytes (model.S), and the end of a program on an unexpected error. */
#ifndef EXAMPLE_H
#define EXAMPLE_H

#include <capsule.h>
#include <stdio.h>
#include <stdlib.h>

extern const unsigned char capsule_file[], capsule_file_end[];
extern const unsigned char second_file[], second_file_end[];

/* Prints a failure in words, with its figures. */
static void explain(const capsule_error *error) {
  printf("%s (status %lu", capsule_status_text(error->status), (unsigned long)error->status);
  if (error->what != NULL) printf(", %.*s", (int)error->what_length, error->what);
  printf(", found %g, least %g, greatest %g)\n", error->found, error->least, error->greatest);
}

/* Ends the program where something failed that cannot fail. */
static void must(capsule_status status, const capsule_error *error) {
  if (status != CAPSULE_STATUS_OK) {
    explain(error);
    exit(1);
  }
}

#endif
