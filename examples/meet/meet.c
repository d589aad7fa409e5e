/* meet WORLD OWN [NAME VALUE]..: a peer in a C program, which owns one of the two balls of meet.wrl, LEFT or RIGHT, and
   drives it to the middle. When it has met the other program's ball it says so and ends. More options are those of
   peerd_options_set(). */
#include <math.h>
#include <peerd/peerd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double kSpeed = 1.5; /* m/s */

static peerd_peer* open_peer(int argc, char** argv) {
  peerd_options* options = peerd_options_new();
  char why[512] = "there is no such option, or it does not take that value";
  int good = peerd_options_set(options, "world", argv[1]) && peerd_options_set(options, "own", argv[2]) &&
             peerd_options_set(options, "name", argv[2]);
  for (int i = 3; i + 1 < argc; i += 2) good = good && peerd_options_set(options, argv[i], argv[i + 1]);
  peerd_peer* peer = good ? peerd_open(options, why, sizeof(why)) : NULL;
  if (peer == NULL) fprintf(stderr, "meet: %s\n", why);
  peerd_options_free(options);
  return peer;
}

/* Whether both balls have an owner who is here. */
static int is_ready(peerd_peer* peer, peerd_object own, peerd_object other) {
  return peerd_in_session(peer) && peerd_member_count(peer) > 0 && peerd_owner(peer, own) == peerd_id(peer) &&
         peerd_owner(peer, other) != 0;
}

int main(int argc, char** argv) {
  if (argc < 3) {
    fprintf(stderr, "usage: meet WORLD LEFT|RIGHT [NAME VALUE]..\n");
    return 2;
  }
  peerd_peer* peer = open_peer(argc, argv);
  if (peer == NULL) return 1;
  const int is_left = strcmp(argv[2], "LEFT") == 0;
  const peerd_object own = peerd_find(peer, argv[2]), other = peerd_find(peer, is_left ? "RIGHT" : "LEFT");

  peerd_motion motion = {0};
  motion.object = own;
  motion.pose.orientation[3] = 1.0;
  motion.velocity[0] = is_left ? kSpeed : -kSpeed;
  double began = NAN;
  int met = 0;
  while (!met && peerd_poll(peer, 0.005)) {
    /* Also events that come when the other program has left already. */
    peerd_event event;
    while (peerd_next_event(peer, &event, sizeof(event))) {
      if (event.kind != PEERD_CONTACT) continue;
      const char* decider = event.peer == peerd_id(peer) ? "this peer" : "the other peer";
      printf("%s met the other ball at x = %.3f m; %s has decided it\n", argv[2],
             (event.pose.position[0] + event.other_pose.position[0]) / 2.0, decider);
      met = 1;
    }
    if (met || !is_ready(peer, own, other)) continue;

    const double now = peerd_session_time(peer);
    if (isnan(began)) {
      if (!peerd_take(peer, own)) break;
      began = now;
    }
    motion.pose.position[0] = (is_left ? -4.0 : 4.0) + motion.velocity[0] * (now - began);
    (void)peerd_move(peer, &motion, 1);
  }
  if (!met) fprintf(stderr, "meet: %s\n", peerd_error(peer));
  for (int i = 0; met && i < 100; ++i) (void)peerd_poll(peer, 0.005); /* the other one is to hear of it, too */
  peerd_close(peer);
  return met ? 0 : 1;
}
