"""Every kind of problem the interface answers with: status, what it means, what to do. Codes are stable."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from grader.contracts.text import Text


@dataclass(frozen=True, slots=True, kw_only=True)
class ProblemType:
    """One kind of problem.

    Attributes:
        fix: what the person who sees it can do.
        headers: of every answer with this problem.
    """

    status: int
    title: Text
    fix: Text
    headers: Mapping[str, str] = field(default_factory=dict)


_RETRY = Text(zh="稍等片刻再试。", en="Wait a moment and try again.")
_ASK = Text(
    zh="请把 instance 告诉助教或管理员。",
    en="Give the instance to an assistant or the operator of the service.",
)

PROBLEM_TYPES: dict[str, ProblemType] = {
    "malformed_body": ProblemType(
        status=400,
        title=Text(zh="请求内容无法解析", en="The request body cannot be read"),
        fix=Text(
            zh="上传文件用 multipart/form-data 和字段 file、assignment、student；其他请求用 UTF-8 编码的 JSON。",
            en="Upload the fields file, assignment and student as multipart/form-data; anything else is JSON in "
            "UTF-8.",
        ),
    ),
    "unauthorized": ProblemType(
        status=401,
        title=Text(zh="需要有效的令牌", en="A valid token is needed"),
        fix=Text(
            zh="在请求头 Authorization 中填写 Bearer 和你的令牌；令牌过期或遗失时向教师要一个新的。"
            "没有设置课程时，用服务启动时显示的令牌。",
            en="Send the header Authorization: Bearer, followed by your token; ask the instructor for a new one "
            "when it has expired or is lost. Without courses it is the token shown when the service started.",
        ),
        headers={"WWW-Authenticate": 'Bearer realm="grader"'},
    ),
    "not_open_yet": ProblemType(
        status=403,
        title=Text(zh="作业还没有开放", en="The assignment is not open yet"),
        fix=Text(zh="等作业开放后再提交。", en="Hand it in once the assignment is open."),
    ),
    "closed": ProblemType(
        status=403,
        title=Text(zh="作业已经截止", en="The assignment is closed"),
        fix=Text(zh="如有特殊情况，请教师延期。", en="Ask an instructor for more time if there is a reason."),
    ),
    "no_attempts_left": ProblemType(
        status=403,
        title=Text(zh="提交次数已用完", en="No attempts are left"),
        fix=Text(zh="如有特殊情况，请教师增加次数。", en="Ask an instructor for more if there is a reason."),
    ),
    "no_attempts_today": ProblemType(
        status=403,
        title=Text(zh="今天的提交次数已用完", en="No attempts are left today"),
        fix=Text(
            zh="先在本机用 grader check 检查，明天再提交。",
            en="Check the script with `grader check` at home, and hand it in tomorrow.",
        ),
    ),
    "forbidden": ProblemType(
        status=403,
        title=Text(zh="你的身份不允许这样做", en="Your role does not allow this"),
        fix=Text(zh="请任课教师来做。", en="Ask an instructor of the course to do it."),
    ),
    "foreign_form": ProblemType(
        status=403,
        title=Text(zh="这个表单已经失效", en="This form is no longer valid"),
        fix=Text(zh="返回上一页，刷新后再提交一次。", en="Go back, reload the page and send it again."),
    ),
    "not_found": ProblemType(
        status=404,
        title=Text(zh="没有这个地址", en="There is nothing at this address"),
        fix=Text(
            zh="检查地址是否完整；程序接口的地址见 /openapi.json。",
            en="Check the address; /openapi.json lists those for programs.",
        ),
    ),
    "submission_not_found": ProblemType(
        status=404,
        title=Text(zh="没有这份提交", en="There is no such submission"),
        fix=Text(zh="检查提交编号是否完整。", en="Check that the submission's id is complete."),
    ),
    "assignment_not_found": ProblemType(
        status=404,
        title=Text(zh="没有这个作业", en="There is no such assignment"),
        fix=Text(zh="看作业清单（/api/v1/assignments）。", en="See the list: /api/v1/assignments."),
    ),
    "no_trajectory": ProblemType(
        status=404,
        title=Text(zh="这次运行没有轨迹", en="This run has no trajectory"),
        fix=Text(
            zh="检查 case 参数；如果程序没有运行起来，就没有轨迹。",
            en="Check the parameter case; a script that never ran has no trajectory.",
        ),
    ),
    "regrade_not_found": ProblemType(
        status=404,
        title=Text(zh="没有这次重评", en="There is no such re-grade"),
        fix=Text(zh="/api/v1/regrades 列出全部重评。", en="/api/v1/regrades lists all of them."),
    ),
    "item_not_found": ProblemType(
        status=404,
        title=Text(zh="没有这个评分项", en="There is no such rubric item"),
        fix=Text(zh="使用 allowed 中的项目之一。", en="Use one of the items in allowed."),
    ),
    "problem_not_found": ProblemType(
        status=404,
        title=Text(zh="没有这种错误类型", en="There is no such kind of problem"),
        fix=Text(zh="检查错误类型的名称。", en="Check the name of the kind of problem."),
    ),
    "method_not_allowed": ProblemType(
        status=405,
        title=Text(zh="这个地址不支持该请求方法", en="This address does not support the method"),
        fix=Text(zh="响应头 Allow 列出支持的方法。", en="The header Allow lists the methods it supports."),
    ),
    "not_graded_yet": ProblemType(
        status=409,
        title=Text(zh="还没有评分结果", en="There is no grading yet"),
        fix=Text(zh="等提交的 status 变成 graded 再试。", en="Try again when its status is graded."),
    ),
    "judged_meanwhile": ProblemType(
        status=412,
        title=Text(zh="这一项已有更新的评分", en="The item was judged or graded again meanwhile"),
        fix=Text(
            zh="重新读取这一项，看过别人的评分后，把它的 ETag 填入 If-Match 再提交。",
            en="Read the item again, look at what was given, and send its ETag as If-Match.",
        ),
    ),
    "changed_meanwhile": ProblemType(
        status=412,
        title=Text(zh="别人刚刚改过", en="Somebody else changed this meanwhile"),
        fix=Text(zh="重新读取，在 If-Match 中用新的 ETag。", en="Read it again; send its ETag as If-Match."),
    ),
    "too_large": ProblemType(
        status=413,
        title=Text(zh="文件太大", en="The file is too large"),
        fix=Text(
            zh="只上传作业脚本本身，不要打包其他文件。", en="Upload the script itself, without other files."
        ),
    ),
    "unsupported_media_type": ProblemType(
        status=415,
        title=Text(zh="请求不是文件上传", en="The request is not a file upload"),
        fix=Text(
            zh="用 multipart/form-data 上传，例如 curl -F file=@square_mover.py。",
            en="Send multipart/form-data, for example with curl -F file=@square_mover.py.",
        ),
        headers={"Accept": "multipart/form-data"},
    ),
    "wrong_file_type": ProblemType(
        status=415,
        title=Text(zh="文件类型不对", en="This is the wrong kind of file"),
        fix=Text(
            zh="上传扩展名为 .py 的脚本；问答题上传 .txt 或 .md 文本。",
            en="Upload the script whose name ends in .py; for a question, a text ending in .txt or .md.",
        ),
    ),
    "invalid_request": ProblemType(
        status=422,
        title=Text(zh="请求中有字段不正确", en="A field of the request is wrong"),
        fix=Text(zh="改正所列的字段。", en="Correct the fields that are named."),
    ),
    "invalid_points": ProblemType(
        status=422,
        title=Text(zh="分数不在允许的范围内", en="The points are out of range"),
        fix=Text(
            zh="给 0 到这一项满分之间的分数，最多两位小数。",
            en="Give points from 0 to the most the item can earn, with at most two decimals.",
        ),
    ),
    "points_unchanged": ProblemType(
        status=422,
        title=Text(zh="机器给的就是这么多分", en="The machine gave these points already"),
        fix=Text(zh="填别的分数，或者不改。", en="Give others, or leave it."),
    ),
    "invalid_student": ProblemType(
        status=422,
        title=Text(zh="学号格式不正确", en="This is not a valid student id"),
        fix=Text(
            zh="使用 1 到 64 个字母、数字或 . _ @ - ，以字母或数字开头。",
            en="Use 1 to 64 letters, digits or . _ @ -, beginning with a letter or digit.",
        ),
    ),
    "regrade_open": ProblemType(
        status=409,
        title=Text(zh="这个作业已有一次重评未决", en="The assignment has an open re-grade"),
        fix=Text(zh="先采用或放弃那一次。", en="Apply or discard that one first."),
    ),
    "regrade_running": ProblemType(
        status=409,
        title=Text(zh="试评还没有全部完成", en="Not every trial grading is done yet"),
        fix=Text(zh="等 waiting 变成 0 再试。", en="Try again when `waiting` is 0."),
    ),
    "regrade_decided": ProblemType(
        status=409,
        title=Text(zh="这次重评已经采用或放弃", en="The re-grade has already been applied or discarded"),
        fix=Text(zh="需要时新开一次重评。", en="Start another one if need be."),
    ),
    "nothing_to_regrade": ProblemType(
        status=422,
        title=Text(zh="没有符合条件的提交", en="No submission matches"),
        fix=Text(zh="放宽 which 或 students。", en="Widen `which` or `students`."),
    ),
    "no_course": ProblemType(
        status=409,
        title=Text(zh="还没有课程", en="There is no course"),
        fix=Text(
            zh="先用 grader course create 创建课程。", en="Create one with `grader course create` first."
        ),
    ),
    "invalid_rules": ProblemType(
        status=422,
        title=Text(zh="规则之间有矛盾", en="The rules contradict each other"),
        fix=Text(zh="改正 detail 所说的规则。", en="Correct the rule that detail names."),
    ),
    "unknown_student": ProblemType(
        status=422,
        title=Text(zh="课程里没有这名学生", en="Nobody in the course has this id"),
        fix=Text(zh="检查学号，或先导入名单。", en="Check the id, or import the roster first."),
    ),
    "unknown_assignment": ProblemType(
        status=422,
        title=Text(zh="没有这个作业", en="There is no such assignment"),
        fix=Text(zh="使用 allowed 中的名称之一。", en="Use one of the names in allowed."),
    ),
    "empty": ProblemType(
        status=422,
        title=Text(zh="文件是空的", en="The file is empty"),
        fix=Text(zh="先在编辑器中保存文件，再上传。", en="Save the file in the editor, then upload it."),
    ),
    "not_utf8": ProblemType(
        status=422,
        title=Text(zh="文件不是 UTF-8 编码", en="The file is not UTF-8"),
        fix=Text(
            zh="在编辑器中选择以 UTF-8 编码保存。", en="Save the file with encoding UTF-8 in the editor."
        ),
    ),
    "contains_nul": ProblemType(
        status=422,
        title=Text(zh="这不是文本文件", en="This is not a text file"),
        fix=Text(
            zh="上传脚本（.py）或文字文件本身，不要上传 Word 文档、压缩包、截图或 .pyc 文件。",
            en="Upload the script (.py) or text itself, not a document, archive, picture or .pyc file.",
        ),
    ),
    "syntax_error": ProblemType(
        status=422,
        title=Text(zh="Python 语法错误", en="This is not valid Python"),
        fix=Text(
            zh="改正所指的那一行（也看看它的上一行），在自己电脑上能运行后再上传。",
            en="Correct that line (look at the one above, too), run it at home, then upload it.",
        ),
    ),
    "key_reused": ProblemType(
        status=422,
        title=Text(zh="Idempotency-Key 已用于另一次上传", en="The Idempotency-Key belongs to another upload"),
        fix=Text(zh="每次新的上传使用新的键。", en="Use a fresh key for each new upload."),
    ),
    "too_many_open": ProblemType(
        status=429,
        title=Text(zh="等待评分的提交太多", en="Too many submissions are waiting"),
        fix=Text(zh="等前面的提交评分完成后再上传。", en="Upload again when earlier ones are graded."),
    ),
    "too_many_requests": ProblemType(
        status=429,
        title=Text(zh="请求太频繁", en="Too many requests"),
        fix=Text(
            zh="稍等片刻再试；响应头 Retry-After 是要等的秒数。",
            en="Wait a moment, then try again; the header Retry-After says how many seconds.",
        ),
    ),
    "too_many_streams": ProblemType(
        status=429,
        title=Text(zh="同时打开的进度流太多", en="Too many streams of events are open"),
        fix=Text(
            zh="关闭其他正在等待评分的页面或程序，或者改为隔几秒查询一次。",
            en="Close other pages or programs that wait for gradings, or ask every few seconds instead.",
        ),
    ),
    "streams_full": ProblemType(
        status=503,
        title=Text(zh="进度流已满", en="No more streams of events can be opened"),
        fix=Text(
            zh="改为隔几秒查询一次；评分不受影响。", en="Ask every few seconds instead; grading goes on."
        ),
    ),
    "internal_error": ProblemType(
        status=500, title=Text(zh="服务内部错误", en="The service made a mistake"), fix=_ASK
    ),
    "unavailable": ProblemType(
        status=503, title=Text(zh="服务暂时不可用", en="The service is not available right now"), fix=_RETRY
    ),
    "refused": ProblemType(status=400, title=Text(zh="请求被拒绝", en="The request was refused"), fix=_ASK),
}
