#!/usr/bin/env bash
# libwebsockets 4.1.6 (Debian 12, libwebsockets17 4.1.6-3): a timer (lws_sul_schedule) sets a flag, and a
# thread ends its loop `while (!flag) lws_service(context, 0);` when the flag is set.
# Expected: lws_service() returns after it has called a timer, as after any other event, so that the loop ends
# when the timer fires, after 10 ms.
# Seen: lws_service() calls the timer, and then waits for the next event in the same call: the loop ends when a
# second timer is due, after 1000 ms.  A loop that schedules its timer anew after each call therefore waits for
# as long as some other timer or socket lets it; the callback has to schedule it.
set -euo pipefail
version=4.1.6-3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get download "libwebsockets17=$version" "libwebsockets-dev=$version" >/dev/null
for package in *.deb; do dpkg -x "$package" .; done
library=$folder/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)
cat >timer.c <<'END'
#include <libwebsockets.h>
#include <stdio.h>
#include <time.h>

static volatile int first, second;
static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}
static double start, fired;
static void on_first(lws_sorted_usec_list_t* list) { (void)list, first = 1, fired = now() - start; }
static void on_second(lws_sorted_usec_list_t* list) { (void)list, second = 1; }

int main(void) {
  struct lws_context_creation_info info = {0};
  lws_sorted_usec_list_t a = {0}, b = {0};
  lws_set_log_level(0, NULL);
  info.port = CONTEXT_PORT_NO_LISTEN;
  struct lws_context* context = lws_create_context(&info);
  if (!context) return 2;
  start = now();
  lws_sul_schedule(context, 0, &a, on_first, 10 * LWS_US_PER_MS);
  lws_sul_schedule(context, 0, &b, on_second, 1000 * LWS_US_PER_MS);
  while (!first) lws_service(context, 0);
  const double left = now() - start;
  printf("timer called after %.0f ms, the loop left after %.0f ms%s\n", fired, left,
         second ? ", the second timer called, too" : "");
  lws_context_destroy(context);
  return !(fired < 200 && left > 900);
}
END
gcc -o timer timer.c -I usr/include -L "$library" -l:libwebsockets.so.17
echo "libwebsockets $(dpkg-deb -f libwebsockets17_*.deb Version):"
LD_LIBRARY_PATH=$library ./timer || { echo "it is different now" >&2; exit 1; }
