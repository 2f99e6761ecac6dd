/* search_host [NAME] - prints the search path, or the code of opening a library by name. The test runs a copy
 * of it set-uid. */
#include <ilaw/loader.h>

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv) {
  static char text[65536];
  if (argc == 2) {
    ilaw_library* library;
    printf("%d\n", (int)ilaw_library_open(argv[1], &library, text, sizeof text));
    return 0;
  }
  ilaw_search_path(text, sizeof text);
  puts(text);
  fflush(stdout);
  _Exit(0); /* a leak check at exit cannot look into a set-uid process, and would say so */
}
