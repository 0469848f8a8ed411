"""LRU, SIEVE, S3-FIFO and Belady once more, from their descriptions, for items of one size.

Each takes requests (a list of ids) and a capacity in items, and returns the number of hits.
"""

from collections import OrderedDict, deque


def lru(requests, capacity):
    held, hits = OrderedDict(), 0
    for item in requests:
        if item in held:
            hits += 1
            held.move_to_end(item)
            continue
        if len(held) == capacity:
            held.popitem(last=False)
        held[item] = None
    return hits


def sieve(requests, capacity):
    """The queue is a list, oldest first; the hand is an index into it."""
    queue, visited, hand, hits = [], {}, 0, 0
    for item in requests:
        if item in visited:
            hits += 1
            visited[item] = True
            continue
        if len(queue) == capacity:
            while visited[queue[hand]]:
                visited[queue[hand]] = False
                hand = (hand + 1) % capacity
            del visited[queue.pop(hand)]
            # What was newer than the victim now stands where the hand points; at the end, the oldest.
            hand = hand if hand < len(queue) else 0
        queue.append(item)
        visited[item] = False
    return hits


def s3_fifo(requests, capacity):
    small_size = capacity // 10
    main_size = capacity - small_size
    small, main, ghost = deque(), deque(), OrderedDict()
    uses, hits = {}, 0
    for item in requests:
        if item in uses:
            hits += 1
            uses[item] = min(3, uses[item] + 1)
            continue
        evicted = len(small) + len(main) < capacity
        while not evicted:
            if len(main) <= main_size and small:
                oldest = small.popleft()
                if uses[oldest] > 1:
                    uses[oldest] = 0
                    main.append(oldest)
                    continue
                del uses[oldest]
                ghost[oldest] = None
                while len(ghost) > main_size:
                    ghost.popitem(last=False)
                evicted = True
            else:
                oldest = main.popleft()
                if uses[oldest] > 0:
                    uses[oldest] -= 1
                    main.append(oldest)
                else:
                    del uses[oldest]
                    evicted = True
        (main if ghost.pop(item, item) is None else small).append(item)
        uses[item] = 0
    return hits


def belady(requests, capacity):
    """What is never used again is used after the end."""
    following, last = [len(requests)] * len(requests), {}
    for i in reversed(range(len(requests))):
        following[i] = last.get(requests[i], len(requests))
        last[requests[i]] = i
    held, hits = {}, 0
    for item, next_use in zip(requests, following):
        if item in held:
            hits += 1
        elif len(held) == capacity:
            del held[max(held, key=held.get)]
        held[item] = next_use
    return hits


TWINS = {"lru": lru, "sieve": sieve, "s3-fifo": s3_fifo, "belady": belady}
