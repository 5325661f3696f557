#include "server.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "recorder.h"

enum { CLIENTS = 8, LINE = 512, WORDS = 64, REPLY = 4096, POLL_MS = 20, PATIENCE = 5000 };

typedef struct {
    int socket; /* -1: free */
    int supervises, skipping; /* skipping: the rest of a line that is too long */
    size_t length;
    char line[LINE];
} client_t;

static struct {
    exchange_t *shared;
    int socket, finish, stop_due;
    char path[sizeof ((struct sockaddr_un *)0)->sun_path];
    client_t clients[CLIENTS];
    pthread_t thread;
} server;

static const char HELP[] =
    "ok status | position | names | move S V.. | step S V.. | ramp S V.. SECONDS | sine S A.. HZ CYCLES | "
    "zigzag S A.. HZ CYCLES | circle S S RADIUS HZ CYCLES | ellipse S R S R HZ CYCLES | hold | record FILE | "
    "record stop | supervise | start | stop, where S is a set-point and values are in its unit";

void fault_text(uint32_t faults, char *text, size_t size)
{
    size_t n = 0;
    for (int i = 0; i < N_FAULTS && n < size; i++) {
        if (faults & (1u << FAULTS[i].bit)) {
            n += (size_t)snprintf(text + n, size - n, "%s%s", n ? ", " : "", FAULTS[i].text);
        }
    }
    if (n == 0u) (void)snprintf(text, size, "-");
}

/* Append to a reply, which stays within REPLY. */
static void add(char *reply, const char *format, ...)
{
    const size_t n = strlen(reply);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(reply + n, REPLY - n, format, arguments);
    va_end(arguments);
}

static void add_values(char *reply, const signal_t signals[], const double values[], int count)
{
    for (int i = 0; i < count; i++) add(reply, " %s=%.9g", signals[i].name, values[i]);
}

static void reply_status(char *reply, const status_t *s)
{
    char faults[1024], cause[1024];
    fault_text(s->faults, faults, sizeof faults);
    fault_text(s->latch_cause, cause, sizeof cause);
    add(reply, "ok phase=%s moving=%d calls=%llu missed=%llu worst_late_us=%.1f dropped=%llu recording=%d",
        PHASES[s->phase], s->moving, (unsigned long long)s->calls, (unsigned long long)s->late.missed,
        (double)s->late.worst_ns / 1000.0, (unsigned long long)recorder_dropped(), recorder_is_open());
    add(reply, " faults=0x%08x (%s) latched_by=0x%08x (%s) reason=%s", (unsigned)s->faults, faults,
        (unsigned)s->latch_cause, cause, s->reason ? s->reason : "-");
    if (s->drive_faults) add(reply, " drive_faults=0x%08x", (unsigned)s->drive_faults);
}

static void reply_names(char *reply)
{
    add(reply, "ok");
    for (int i = 0; i < N_SET_POINTS; i++) {
        add(reply, " %s[%s]=%.6g..%.6g", SET_POINTS[i].name, SET_POINTS[i].unit, SET_POINTS[i].low, SET_POINTS[i].high);
    }
}

static int put(const command_t *command)
{
    const int64_t place = ring_place(&server.shared->command_ring, COMMANDS);
    if (place < 0) return -1;
    server.shared->commands[place] = *command;
    ring_publish(&server.shared->command_ring);
    return 0;
}

/* Wait for the loop to obey, so that the next `status` shows what this command did. */
static void send_order(char *reply, const command_t *command)
{
    const struct timespec pause = {.tv_nsec = 100000};
    const uint64_t before = board_latest(&server.shared->board)->commands;
    int waited = put(command) == 0 ? 0 : PATIENCE;
    while (waited < PATIENCE && board_latest(&server.shared->board)->commands == before) {
        (void)nanosleep(&pause, NULL);
        waited++;
    }
    add(reply, waited < PATIENCE ? "ok" : "error: the loop does not answer: look at its log");
}

static void reply_motion(char *reply, char *words[], int count, const status_t *s)
{
    command_t command = {.order = COMMAND_MOTION};
    char message[256];
    if (motion_parse(words, count, s->set_points, &command.motion, message, sizeof message) != 0) {
        add(reply, "error: %s", message);
    } else if (s->phase != RUNNING || s->moving) {
        add(reply, "error: the machine is %s%s: a motion needs a running machine at rest", PHASES[s->phase],
            s->moving ? " and moving" : "");
    } else {
        send_order(reply, &command);
    }
}

static void reply_record(char *reply, char *words[], int count)
{
    if (count != 2) {
        add(reply, "error: `record` needs one word: a file, or stop");
    } else if (strcmp(words[1], "stop") == 0) {
        add(reply, recorder_stop() == 0 ? "ok" : "error: the disk does not answer: the record is not closed yet");
    } else {
        const int error = recorder_open(words[1]);
        if (error == EBUSY && recorder_is_open()) add(reply, "error: a record is running: `record stop` first");
        else if (error) add(reply, "error: '%.200s' cannot be recorded to: %s", words[1], strerror(error));
        else add(reply, "ok");
    }
}

static int stands_alone(const char *verb)
{
    static const char *const verbs[] = {"help", "status", "names", "position", "hold", "supervise", "start", "stop"};
    for (size_t i = 0; i < sizeof verbs / sizeof verbs[0]; i++) {
        if (strcmp(verb, verbs[i]) == 0) return 1;
    }
    return 0;
}

static void obey(client_t *client, char *reply)
{
    char *words[WORDS], *rest = client->line;
    const status_t *const s = board_latest(&server.shared->board);
    int count = 0;
    for (char *word; count < WORDS && (word = strtok_r(rest, " \t\r", &rest)) != NULL;) words[count++] = word;
    const char *const verb = count ? words[0] : "";
    if (count == WORDS) add(reply, "error: more than %d words: send fewer", WORDS - 1);
    else if (strcmp(verb, "record") == 0) reply_record(reply, words, count);
    else if (count > 1 && stands_alone(verb)) add(reply, "error: `%s` stands alone: leave out '%s'", verb, words[1]);
    else if (strcmp(verb, "help") == 0) add(reply, "%s", HELP);
    else if (strcmp(verb, "status") == 0) reply_status(reply, s);
    else if (strcmp(verb, "names") == 0) reply_names(reply);
    else if (strcmp(verb, "position") == 0) {
        add(reply, "ok");
        add_values(reply, SENSORS, s->sensors, N_SENSORS);
        add_values(reply, SET_POINTS, s->set_points, N_SET_POINTS);
        add_values(reply, OUTPUTS, s->outputs, N_OUTPUTS);
    } else if (strcmp(verb, "hold") == 0) send_order(reply, &(command_t){.order = COMMAND_HOLD});
    else if (strcmp(verb, "stop") == 0) {
        send_order(reply, &(command_t){.order = COMMAND_STOP, .reason = "a client asked for it"});
    } else if (strcmp(verb, "start") == 0) {
        if (s->may_start) send_order(reply, &(command_t){.order = COMMAND_START});
        else add(reply, "error: the machine is %s: a start needs a disabled machine at rest", PHASES[s->phase]);
    } else if (strcmp(verb, "supervise") == 0) {
        client->supervises = 1;
        add(reply, "ok");
    } else reply_motion(reply, words, count, s);
}

static void drop(client_t *client)
{
    if (client->supervises) server.stop_due = 1;
    (void)close(client->socket);
    *client = (client_t){.socket = -1};
}

/* A client that does not read its replies is dropped: nobody waits for it. */
static void answer(client_t *client)
{
    char reply[REPLY + 1] = "";
    client->line[client->length] = '\0';
    int printable = strlen(client->line) == client->length;
    for (size_t i = 0; i < client->length; i++) {
        printable &= isprint((unsigned char)client->line[i]) || client->line[i] == '\t' || client->line[i] == '\r';
    }
    if (client->skipping) add(reply, "error: a line is longer than %d bytes: send a shorter one", LINE - 1);
    else if (!printable) add(reply, "error: a line has bytes that are not printable: send ASCII");
    else obey(client, reply);
    const size_t n = strlen(reply);
    reply[n] = '\n';
    client->length = 0u;
    client->skipping = 0;
    if (send(client->socket, reply, n + 1u, MSG_NOSIGNAL | MSG_DONTWAIT) != (ssize_t)(n + 1u)) drop(client);
}

static void receive(client_t *client)
{
    char bytes[LINE];
    const ssize_t n = recv(client->socket, bytes, sizeof bytes, MSG_DONTWAIT);
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) drop(client);
    for (ssize_t i = 0; i < n && client->socket >= 0; i++) {
        if (bytes[i] == '\n') answer(client);
        else if (client->length + 1u < LINE) client->line[client->length++] = bytes[i];
        else client->skipping = 1;
    }
}

static void accept_client(void)
{
    const int s = accept(server.socket, NULL, NULL);
    struct ucred peer = {0};
    socklen_t size = sizeof peer;
    int k = 0;
    if (s < 0) return;
    while (k < CLIENTS && server.clients[k].socket >= 0) k++;
    const int owner = getsockopt(s, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 && peer.uid == geteuid();
    if (k < CLIENTS && owner) {
        server.clients[k].socket = s;
        return;
    }
    const char *const refusal = owner ? "error: as many clients are connected as there are places: end one of them\n"
        : "error: the socket serves its owner alone: connect as the user of the loop\n";
    (void)send(s, refusal, strlen(refusal), MSG_NOSIGNAL | MSG_DONTWAIT);
    (void)close(s);
}

/* Print the changes of the phase, with the reason of a stop. */
static void print_events(void)
{
    ring_t *const ring = &server.shared->event_ring;
    for (int64_t place; (place = ring_next(ring, EVENTS)) >= 0; ring_release(ring)) {
        const event_t event = server.shared->events[place];
        const int stopped = event.phase > RUNNING && event.reason != NULL;
        (void)fprintf(stderr, "%s: %s%s%s\n", STAGE_NAME, PHASES[event.phase], stopped ? ": " : "",
            stopped ? event.reason : "");
    }
}

static void *run(void *ignored)
{
    const command_t stop = {.order = COMMAND_STOP, .reason = "the supervising client is gone"};
    while (!__atomic_load_n(&server.finish, __ATOMIC_ACQUIRE)) {
        struct pollfd polled[CLIENTS + 1] = { {.fd = server.socket, .events = POLLIN} };
        for (int k = 0; k < CLIENTS; k++) polled[k + 1] = (struct pollfd){server.clients[k].socket, POLLIN, 0};
        (void)poll(polled, CLIENTS + 1, POLL_MS);
        for (int k = 0; k < CLIENTS; k++) {
            if (polled[k + 1].revents && server.clients[k].socket >= 0) receive(&server.clients[k]);
        }
        if (polled[0].revents) accept_client();
        if (server.stop_due && put(&stop) == 0) server.stop_due = 0;
        print_events();
    }
    print_events();
    return ignored;
}

int server_start(const char *path, exchange_t *exchange)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    if (strlen(path) >= sizeof address.sun_path) {
        (void)fprintf(stderr, "socket: the path '%s' has %zu bytes, at most %zu are possible: choose a shorter --run\n",
            path, strlen(path), sizeof address.sun_path - 1u);
        return -1;
    }
    (void)strcpy(address.sun_path, path);
    (void)strcpy(server.path, path);
    server.shared = exchange;
    for (int k = 0; k < CLIENTS; k++) server.clients[k].socket = -1;
    (void)unlink(path); /* the lock file says that no other instance uses it */
    server.socket = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const mode_t before = umask(0177); /* owner only, from the first moment on */
    const int bound = bind(server.socket, (const struct sockaddr *)&address, sizeof address);
    (void)umask(before);
    if (bound != 0 || listen(server.socket, CLIENTS) != 0 || pthread_create(&server.thread, NULL, run, NULL) != 0) {
        (void)fprintf(stderr, "socket: '%s' cannot be served: %s: choose a folder with --run\n", path, strerror(errno));
        return -1;
    }
    return 0;
}

void server_finish(void)
{
    __atomic_store_n(&server.finish, 1, __ATOMIC_RELEASE);
    (void)pthread_join(server.thread, NULL);
    (void)close(server.socket);
    (void)unlink(server.path);
}
