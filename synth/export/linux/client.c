/* Send one command to the loop and print its answer: `client SOCKET status`. Exit status 0 for an answer of ok, 1 for
 * an error, 2 where no answer came. */
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

int main(int count, char *words[])
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    char line[8192] = "";
    size_t n = 0;
    if (count < 3 || strlen(words[1]) >= sizeof address.sun_path) {
        (void)fprintf(stderr, "usage: client SOCKET COMMAND...; the command `help` lists all\n");
        return 2;
    }
    (void)strcpy(address.sun_path, words[1]);
    const int s = socket(AF_UNIX, SOCK_STREAM, 0);
    if (s < 0 || connect(s, (const struct sockaddr *)&address, sizeof address) != 0) {
        perror(words[1]);
        return 2;
    }
    for (int k = 2; k < count && n < sizeof line; k++) {
        n += (size_t)snprintf(line + n, sizeof line - n, "%s%s", words[k], k + 1 < count ? " " : "\n");
    }
    if (n >= sizeof line) {
        (void)fprintf(stderr, "the command is longer than %zu bytes: make it shorter\n", sizeof line - 1u);
        return 2;
    }
    /* A loop that turns a client away may have closed before it reads: its answer is there nevertheless. */
    (void)send(s, line, n, MSG_NOSIGNAL);
    n = 0;
    while (n + 1u < sizeof line && (n == 0u || line[n - 1u] != '\n')) {
        const ssize_t more = read(s, line + n, sizeof line - 1u - n);
        if (more <= 0) break;
        n += (size_t)more;
    }
    if (n == 0u || line[n - 1u] != '\n') {
        (void)fprintf(stderr, "%s: no answer came: look whether the loop still runs, and at its log\n", words[1]);
        return 2;
    }
    line[n] = '\0';
    (void)fputs(line, stdout);
    (void)close(s);
    return strncmp(line, "ok", 2) == 0 ? 0 : 1;
}
