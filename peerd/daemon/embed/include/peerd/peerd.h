/* A peer of a shared world inside a program: the C interface of libpeerd. It needs no other header; peerd.hpp is the
   same for C++17.

   A program opens a peer, drives it by peerd_poll() in its own loop, or lets it run in a thread of its own by
   peerd_start(), and meanwhile reads where everything is, moves what the peer owns, edits the world and takes events.

   Units are metres, seconds and radians. Places and velocities are in the world's frame, which is VRML's: right-handed,
   y up. An orientation is a unit quaternion x, y, z, w that turns the object's axes into the world's.

   Functions that return an int return 1 where it was done, 0 where it was not; peerd_error() then says why. All of one
   peer's functions are called from one thread at a time; after peerd_start() any threads may call them at once. Texts
   that a function returns, and those of an event, are valid until the next call for that peer: where other threads call
   it, too, hold the peer (peerd_hold()) for as long as you read them, and from a call to its peerd_error().

   A peer belongs to the process that opened it. In a child of fork() all its functions are refused at once, and send
   nothing: they return 0, null, NaN, PEERD_NO_OBJECT or -1, and peerd_error() says why; peerd_has_left() returns 1.
   There peerd_close() does nothing but let go of the peer, whose memory and descriptors the child has until it ends or
   runs another program. A child may open peers of its own. */
#ifndef PEERD_H
#define PEERD_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PEERD_API __attribute__((visibility("default")))

/* The version of this interface, which is part of the library's soname. Below 1.0 each MINOR is an interface of its own:
   a program that is built against 0.1 runs with every library of 0.1, however much newer. From 1.0 on that holds for
   each MAJOR, and a MINOR only adds. */
#define PEERD_API_MAJOR 0
#define PEERD_API_MINOR 1

/* The version of the library, such as "0.9.0". */
PEERD_API const char* peerd_version(void);

/* ---- opening and closing ---- */

typedef struct peerd_options peerd_options;
typedef struct peerd_peer peerd_peer;

/* Never null. */
PEERD_API peerd_options* peerd_options_new(void);
PEERD_API void peerd_options_free(peerd_options* options);

/* Sets an option by its name, which is that of `peerd run` without the dashes: world, world-name, name, id, own, config,
   peer, set, interface, group, port, store, control, view, key, password-file; open, fresh, take-over and verbose take
   "yes" or "no". own and set may be given several times. Without them there is no store, no control socket and no
   viewer. In place of a world's file, those of `peerd join` get it from peers that are in it: join (the world's name;
   "": the only one), from (HOST:PORT of a peer), invite (a line of `peerd invite`). 0: there is no such option, or it
   does not take that value. */
PEERD_API int peerd_options_set(peerd_options* options, const char* name, const char* value);

/* Lines of the peer's log go there, from debug (0) over info (1) and warning (2) to error (3); without it they are lost.
   The function is called from within other calls, or in the peer's thread, and must not call any of these functions. In
   C++ it may throw: that line is lost, and the first time is said on standard error. */
typedef void (*peerd_log)(void* user, int level, const char* text);
PEERD_API void peerd_options_log(peerd_options* options, peerd_log log, void* user);

/* Reads the world, or gets it from others, which takes a second or more; opens the network and all else. Null: it can't,
   and a sentence that says why is written to `error`, as far as it fits into `size` bytes, with its terminating zero.
   The options may be freed then, or opened with again. */
PEERD_API peerd_peer* peerd_open(const peerd_options* options, char* error, size_t size);

/* Says goodbye to the others, if that was not said before, and ends the peer. Null is no peer. */
PEERD_API void peerd_close(peerd_peer* peer);

/* Why the last call that failed did; "" where none has. A call that succeeds leaves it as it is. */
PEERD_API const char* peerd_error(peerd_peer* peer);

/* ---- driving ---- */

/* Does what is due: takes datagrams, ticks, sends. Where nothing is due it waits for that, at most so long, and then
   returns, having done one thing or none. 0: the peer has left, or has a thread. Call it some sixty times a second or
   more often: updates wait for it, and so do contacts. */
PEERD_API int peerd_poll(peerd_peer* peer, double at_most_s);

/* From now on the peer runs in a thread of its own, until it is closed; nobody calls peerd_poll(). */
PEERD_API int peerd_start(peerd_peer* peer);

/* From peerd_hold() to peerd_unhold(), in one thread, the peer's own thread and all others that call it wait, so that
   several calls see one moment, and cost one wait in place of one each. Pairs may nest. Without a thread these do
   nothing. */
PEERD_API void peerd_hold(peerd_peer* peer);
PEERD_API void peerd_unhold(peerd_peer* peer);

/* Leaves the session. The peer's thread ends; peerd_poll() returns 0. */
PEERD_API void peerd_leave(peerd_peer* peer);
/* Whether it has left, by itself too, as where another peer of its number is running. */
PEERD_API int peerd_has_left(peerd_peer* peer);

/* ---- the session ---- */

PEERD_API uint32_t peerd_id(peerd_peer* peer); /* of this peer, from 1 */
/* Whether it has a session's time, which all of its peers share. */
PEERD_API int peerd_in_session(peerd_peer* peer);
PEERD_API double peerd_session_time(peerd_peer* peer); /* NaN: it is in none */
PEERD_API size_t peerd_member_count(peerd_peer* peer); /* the other peers that are here */

/* ---- what there is ---- */

/* A node of the scene, in one of the places where it stands: the same number at all peers for as long as the world
   lives. */
typedef uint64_t peerd_object;
#define PEERD_NO_OBJECT UINT64_MAX

/* By its path, such as "CAR" or "TOWN/CAR/WHEEL". PEERD_NO_OBJECT: there is none. */
PEERD_API peerd_object peerd_find(peerd_peer* peer, const char* path);
/* Null: there is no such object. */
PEERD_API const char* peerd_path(peerd_peer* peer, peerd_object object);
/* Whose it is; 0: nobody's. */
PEERD_API uint32_t peerd_owner(peerd_peer* peer, peerd_object object);
/* Writes the objects that somebody owns, ascending, as far as there is room. Returns how many there are. */
PEERD_API size_t peerd_owned_objects(peerd_peer* peer, peerd_object* out, size_t room);
/* The scene as it is now, as VRML97. Null: it has more than 4 MiB, or can't be written. */
PEERD_API const char* peerd_world(peerd_peer* peer);

/* ---- where it is ---- */

typedef struct peerd_pose {
  double position[3];
  double orientation[4]; /* x, y, z, w */
} peerd_pose;

/* Where they are now, at the time of peerd_session_time(), as a viewer of this peer shows them: own objects where they
   are, those of others where they are predicted to be. NaN: there is no such object, or no session yet. Returns how many
   there are. */
PEERD_API size_t peerd_poses(peerd_peer* peer, const peerd_object* objects, size_t count, peerd_pose* out);

/* ---- moving what this peer owns ---- */

/* Asks for an object, or says of one that a configuration gave to this peer that this program moves it; needs a session
   (peerd_in_session()). 1: it was asked for. An object of nobody is this peer's a little later, and another peer may
   give one of its own; PEERD_OBJECT_GIVEN and peerd_owner() say so. The first peerd_move() then ends what physics or a
   formula did with it: it answers no contact by itself, and PEERD_CONTACT says what it meets. */
PEERD_API int peerd_take(peerd_peer* peer, peerd_object object);
/* Gives an object back: it is nobody's a little later. What answers contacts goes on with the velocity that it was
   given, and all else stands. */
PEERD_API int peerd_release(peerd_peer* peer, peerd_object object);

typedef struct peerd_motion {
  peerd_object object;
  peerd_pose pose;
  /* Of the object's origin. NaN: found from its poses, which is less exact; 0 says that it stands. */
  double velocity[3];
  int32_t jumps;    /* 1: it was placed, and has not moved there */
  int32_t reserved; /* 0 */
} peerd_motion;

/* Where objects that were taken are now; call it each frame, for all of them at once. An update goes out to other peers
   only where they could not predict it; an object without a motion for half a second stands still. Returns how many
   motions were used: of the others this program may not move the object, or their numbers are wrong, and peerd_error()
   says so of the last one. */
PEERD_API size_t peerd_move(peerd_peer* peer, const peerd_motion* motions, size_t count);

/* ---- changing the world ---- */

/* An edit of the world by this peer. It takes effect at all peers at one instant, some 100 ms later, and outlives this
   peer where others or a store have it. */
typedef struct peerd_operation {
  uint32_t author;
  uint32_t number; /* 0: none */
} peerd_operation;

/* All of these need a session (peerd_in_session()); `operation` may be null. 0: it was refused, and nothing changes. An
   edit that changes nothing because others have edited meanwhile is named by PEERD_EDIT.

   Adds the nodes of a VRML text below an object, or at the top level (PEERD_NO_OBJECT). */
PEERD_API int peerd_add(peerd_peer* peer, peerd_object under, const char* vrml, peerd_operation* operation);
PEERD_API int peerd_remove(peerd_peer* peer, peerd_object object, peerd_operation* operation);
PEERD_API int peerd_reparent(peerd_peer* peer, peerd_object object, peerd_object under, peerd_operation* operation);
/* Sets a field of the node at the path to a value in the notation of VRML, such as "translation" to "1 2 3". */
PEERD_API int peerd_set(peerd_peer* peer, const char* path, const char* field, const char* value,
                        peerd_operation* operation);
/* Keeps data of an application at a node, by key: any UTF-8. A null value removes the key. */
PEERD_API int peerd_set_data(peerd_peer* peer, const char* path, const char* key, const char* value,
                             peerd_operation* operation);
/* Null: there is none. */
PEERD_API const char* peerd_data(peerd_peer* peer, const char* path, const char* key);
/* The same for values in which there may be zero bytes: `size` is without a terminating one, which the value that
   is returned has besides. */
PEERD_API int peerd_set_sized_data(peerd_peer* peer, const char* path, const char* key, const char* value, size_t size,
                                   peerd_operation* operation);
PEERD_API const char* peerd_sized_data(peerd_peer* peer, const char* path, const char* key, size_t* size);
/* Sends a message to all peers, this one too. */
PEERD_API int peerd_send(peerd_peer* peer, const char* topic, const char* text, peerd_operation* operation);
PEERD_API int peerd_undo(peerd_peer* peer, peerd_operation* operation);
PEERD_API int peerd_redo(peerd_peer* peer, peerd_operation* operation);

/* Anything else: a request of the control protocol, and its reply, both JSON objects. */
PEERD_API const char* peerd_ask(peerd_peer* peer, const char* request);

/* ---- events ---- */

typedef enum peerd_event_kind {
  PEERD_PEER_JOINED = 1, /* peer, name */
  PEERD_PEER_LEFT = 2,   /* peer, name: it has said goodbye, or nothing for a while */
  /* object, the collider of an interest, has met other at that time; peer has found or decided it, 0: nobody owns them.
     Two objects that are both each other's collider meet once. */
  PEERD_CONTACT = 3,
  PEERD_OBJECT_GIVEN = 4, /* object is peer's from now on; 0: nobody's */
  PEERD_MESSAGE = 5,      /* name (the topic), text, peer */
  PEERD_DATA = 6,         /* name (the key) at path, a node's; text; text is null: it is gone */
  PEERD_EDIT = 7,         /* operation has taken effect; text: why it changes nothing, else null */
  PEERD_EVENTS_LOST = 8,  /* count events were not taken in time */
  /* The contact of object and other at that time, which this peer has told of, does not count: another peer had decided
     it otherwise, and a PEERD_CONTACT with its decision came before this or comes next. */
  PEERD_CONTACT_OVERRULED = 9
} peerd_event_kind;

/* Later versions add members at the end. What an event's kind does not name is 0 or null. The velocities after a contact
   are what the world's CollisionResponse nodes make of it; an object that a program moves does not answer by itself, so
   of it both are the same, and what it does then is the program's to say. */
typedef struct peerd_event {
  uint32_t kind;
  uint32_t peer;
  double time; /* session time of it */
  peerd_object object, other;
  /* PEERD_CONTACT: where both were, their velocities, and the normal of the other's surface, which faces object */
  peerd_pose pose, other_pose;
  double velocity_before[3], velocity_after[3];
  double other_velocity_before[3], other_velocity_after[3];
  double normal[3];
  peerd_operation operation;
  const char* name;
  const char* text;
  const char* path;
  uint64_t count;
} peerd_event;

/* Takes the next event; `size` is sizeof(peerd_event) as the program knows it. 0: there is none now. Of more than 65,536
   that wait the oldest are lost. */
PEERD_API int peerd_next_event(peerd_peer* peer, peerd_event* event, size_t size);

/* A file descriptor for a program that waits in a loop of its own, by poll() or epoll: it is readable while events wait,
   until peerd_next_event() has said that there is none, and for ever once the peer has left. It is the peer's: a program
   neither reads nor closes it. */
PEERD_API int peerd_event_descriptor(peerd_peer* peer);

#ifdef __cplusplus
}
#endif
#endif
