/* How often a Traffic Manager's thread is woken while it goes to sleep, by the server's wait before a tick's answer.

       cc -O2 -pthread -o /tmp/lost_wakes benchmarks/lost_wakes.c
       /tmp/lost_wakes SECONDS STEP_MS FRAME_MS BATCH_MS WAIT_MS...

   LibCarla 0.9.16 wakes that thread without holding its lock. A wake between the thread's last look and its sleep is lost,
   and the client hangs. This program has the client's three threads (the one that ticks, the Traffic Manager's, the one
   that receives) and a server in a process of its own. Here the lock is held, so that nothing hangs. The program counts
   the ticks in which a wake falls within NEAR_S of its sleeper's sleep: the manager's, and the ticking thread's, which
   sleeps until the step ends. The waits take turns of TURN ticks, under the same load.
*/

#define _GNU_SOURCE
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define MOST_WAITS 8
#define CALL_S 50e-6 /* a small call on the server */
#define NEAR_S 20e-6
#define TURN 50

enum { TICK = 't', QUESTION = 'q', BATCH = 'b' }; /* calls; the answer to each is the same letter */

static double clock_s(clockid_t which) {
  struct timespec now;
  clock_gettime(which, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double now_s(void) { return clock_s(CLOCK_MONOTONIC); }

static void work(double seconds) {
  double until_s = clock_s(CLOCK_THREAD_CPUTIME_ID) + seconds;
  while (clock_s(CLOCK_THREAD_CPUTIME_ID) < until_s) {
  }
}

static void put(int socket, char letter) {
  if (write(socket, &letter, 1) != 1) exit(1);
}

/* Connect two sockets over TCP, as client and server are. */
static void connect_pair(int *client, int *server) {
  struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  socklen_t size = sizeof address;
  int listener = socket(AF_INET, SOCK_STREAM, 0), on = 1;
  *client = socket(AF_INET, SOCK_STREAM, 0);
  if (bind(listener, (struct sockaddr *)&address, size) || listen(listener, 1) ||
      getsockname(listener, (struct sockaddr *)&address, &size) || connect(*client, (struct sockaddr *)&address, size))
    exit(1);
  *server = accept(listener, NULL, NULL);
  setsockopt(*client, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  setsockopt(*server, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  close(listener);
}

/* The server: a tick is answered when the question has been answered for as long as the wait of its turn says. */
static void serve(int socket, double frame_s, double batch_s, const double *waits_s, int count) {
  long ticks = 0;
  int ticked = 0, asked = 0;
  double until_s = 0.0;
  for (;;) {
    double left_s = ticked && asked ? until_s - now_s() : 1.0;
    if (left_s <= 0.0) {
      ticked = asked = 0;
      ticks++;
      put(socket, TICK);
      continue;
    }
    struct pollfd watched = {socket, POLLIN, 0};
    struct timespec wait = {0, (long)(left_s >= 1.0 ? 999999999.0 : 1e9 * left_s)};
    char letter;
    if (ppoll(&watched, 1, &wait, NULL) <= 0) continue;
    if (read(socket, &letter, 1) != 1) exit(0);
    if (letter == TICK) {
      work(frame_s);
      ticked = 1;
      continue;
    }
    work(letter == BATCH ? batch_s : CALL_S);
    put(socket, letter);
    if (letter == QUESTION) {
      asked = 1;
      until_s = now_s() + waits_s[ticks / TURN % count];
    }
  }
}

static int server_socket;
static double step_s;

static pthread_mutex_t answers = PTHREAD_MUTEX_INITIALIZER, steps = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t of_tick = PTHREAD_COND_INITIALIZER, of_traffic = PTHREAD_COND_INITIALIZER;
static pthread_cond_t step_begin = PTHREAD_COND_INITIALIZER, step_end = PTHREAD_COND_INITIALIZER;
static int tick_answered, traffic_answered, has_begun, has_ended;
static double slept_s; /* when the manager went to sleep before the step that runs */
static double ended_s; /* when that step ended */
static atomic_long sleeps;

static int is_near(double one_s, double other_s) { return one_s - other_s < NEAR_S && other_s - one_s < NEAR_S; }

static void *receive(void *unused) {
  char letter;
  while (read(server_socket, &letter, 1) == 1) {
    pthread_mutex_lock(&answers);
    *(letter == TICK ? &tick_answered : &traffic_answered) = 1;
    pthread_cond_signal(letter == TICK ? &of_tick : &of_traffic);
    pthread_mutex_unlock(&answers);
  }
  exit(0);
  return unused;
}

static void call(char letter, int *answered, pthread_cond_t *comes) {
  put(server_socket, letter);
  pthread_mutex_lock(&answers);
  while (!*answered) pthread_cond_wait(comes, &answers);
  *answered = 0;
  pthread_mutex_unlock(&answers);
}

static void *manage_traffic(void *unused) {
  for (;;) {
    call(QUESTION, &traffic_answered, &of_traffic);
    pthread_mutex_lock(&steps);
    double asleep_s = now_s();
    sleeps++;
    while (!has_begun) pthread_cond_wait(&step_begin, &steps);
    has_begun = 0;
    slept_s = asleep_s;
    pthread_mutex_unlock(&steps);
    work(step_s);
    call(BATCH, &traffic_answered, &of_traffic);
    pthread_mutex_lock(&steps);
    has_ended = 1;
    ended_s = now_s();
    pthread_cond_signal(&step_end);
    pthread_mutex_unlock(&steps);
  }
  return unused;
}

int main(int argc, char **argv) {
  int count = argc - 5, server, near_by[MOST_WAITS] = {0}, near_end[MOST_WAITS] = {0}, awake[MOST_WAITS] = {0}, ticks[MOST_WAITS] = {0};
  double waits_s[MOST_WAITS], took_s[MOST_WAITS] = {0}, load;
  if (count < 1 || count > MOST_WAITS) {
    fprintf(stderr, "usage: %s SECONDS STEP_MS FRAME_MS BATCH_MS WAIT_MS... (at most %d)\n", argv[0], MOST_WAITS);
    return 2;
  }
  for (int i = 0; i < count; i++) waits_s[i] = 1e-3 * atof(argv[5 + i]);
  step_s = 1e-3 * atof(argv[2]);
  connect_pair(&server_socket, &server);
  pid_t child = fork();
  if (child == 0) {
    close(server_socket);
    serve(server, 1e-3 * atof(argv[3]), 1e-3 * atof(argv[4]), waits_s, count);
  }
  close(server);
  pthread_t receiver, manager;
  pthread_create(&receiver, NULL, receive, NULL);
  pthread_create(&manager, NULL, manage_traffic, NULL);
  double end_s = now_s() + atof(argv[1]);
  for (long done = 0; now_s() < end_s; done++) {
    int i = (int)(done / TURN % count);
    double began_s = now_s();
    call(TICK, &tick_answered, &of_tick);
    double woken_s = now_s();
    awake[i] += sleeps <= done;
    pthread_mutex_lock(&steps);
    has_begun = 1;
    pthread_cond_signal(&step_begin);
    pthread_mutex_unlock(&steps);
    pthread_mutex_lock(&steps);
    double asleep_s = now_s();
    while (!has_ended) pthread_cond_wait(&step_end, &steps);
    has_ended = 0;
    near_by[i] += is_near(slept_s, woken_s);
    near_end[i] += is_near(asleep_s, ended_s);
    pthread_mutex_unlock(&steps);
    took_s[i] += now_s() - began_s;
    ticks[i]++;
  }
  getloadavg(&load, 1);
  printf("                                            wake within 20 us of the sleep (load %.0f)\n", load);
  printf("wait ms    ticks  ms a tick  not asleep  begin of a step  end of a step\n");
  for (int i = 0; i < count; i++)
    printf("%7.2f  %7d  %9.2f  %9.2f%%  %14.2f%%  %12.2f%%\n", 1e3 * waits_s[i], ticks[i],
           1e3 * took_s[i] / ticks[i], 100.0 * awake[i] / ticks[i], 100.0 * near_by[i] / ticks[i],
           100.0 * near_end[i] / ticks[i]);
  fflush(stdout);
  kill(child, SIGKILL); /* the thread that receives then ends this process */
  return 0;
}
