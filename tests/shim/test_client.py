"""Service clients and servers."""

from textwrap import dedent

PREFIX = """
import time
import rclpy
from rclpy.node import Node
from std_srvs.srv import Empty, SetBool, Trigger
rclpy.init()
node = Node("n")
def seconds():
    return round(time.time() - 1_700_000_000, 2)
"""


def run_lines(run_script, source, **options):
    run = run_script(PREFIX + dedent(source), **options)
    assert run.exit["reason"] == 0, run.stderr + run.exit["text"]
    return run.stdout.splitlines()


def test_wait_for_service_steps_by_a_quarter_second(run_script):
    source = """
        client = node.create_client(Trigger, "nobody")
        print(client.service_is_ready(), client.wait_for_service(timeout_sec=0.1), seconds())
        print(client.wait_for_service(1.0), seconds())
        node.create_service(Trigger, "nobody", lambda q, a: a)
        print(client.wait_for_service(), seconds())
    """
    assert run_lines(run_script, source) == ["False False 0.25", "False 1.25", "True 1.25"]


def test_call_async_and_spin(run_script):
    source = """
        def handle(request, response):
            response.success = not request.data
            return response
        service = node.create_service(SetBool, "flip", handle)
        client = node.create_client(SetBool, "flip")
        future = client.call_async(SetBool.Request(data=False))
        future.add_done_callback(lambda f: print("done", f.result().success))
        print(future.done())
        rclpy.spin_until_future_complete(node, future)
        print(future.result(), client.srv_name)
        rclpy.spin_once(node, timeout_sec=0)
        rclpy.spin_once(node, timeout_sec=0)
    """
    assert run_lines(run_script, source) == [
        "False",
        "std_srvs.srv.SetBool_Response(success=True, message='') flip",
        "done True",
    ]


def test_call_from_another_thread(run_script):
    source = """
        import threading
        node.create_service(Trigger, "s", lambda q, a: setattr(a, "message", "hello") or a)
        client = node.create_client(Trigger, "s")
        threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
        print(client.call(Trigger.Request()).message)
    """
    assert run_lines(run_script, source) == ["hello"]


def test_wrong_requests_and_responses(run_script):
    source = """
        client = node.create_client(Trigger, "s")
        for request in (Trigger.Response(), Trigger, None):
            try:
                client.call_async(request)
            except TypeError:
                print("refused")
        node.create_service(Trigger, "s", lambda q, a: None)
        client.call_async(Trigger.Request())
        try:
            rclpy.spin_once(node)
        except TypeError as error:
            print("no response", error.args)
    """
    assert run_lines(run_script, source) == ["refused"] * 3 + ["no response ()"]


def test_a_service_of_the_world(run_script):
    source = """
        client = node.create_client(Empty, "/reset")
        print(client.wait_for_service(1.0), seconds())
        future = client.call_async(Empty.Request())
        rclpy.spin_until_future_complete(node, future)
        print(future.result(), seconds())
    """
    out = run_lines(run_script, source, services={"/reset": lambda request: b"\0\1\0\0\0"})
    assert out == ["True 0.0", "std_srvs.srv.Empty_Response() 0.0"]
